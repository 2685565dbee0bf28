"""Compiled loops give the numbers of the array operations, with any number of threads."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import sie
from sie.basis import compiled, sums
from sie.dense.system import System
from sie.fast.zone_sums import ZoneSums
from sie.jumps.right_side import ForcingJumps
from sie.trees.far import FarSum, Nested
from sie.trees.tree import TERMS, Tree


@pytest.fixture(params=[1, 2, 3])
def threads(request, monkeypatch) -> None:
    """Run the test with a given number of threads, whatever the number of processors."""
    monkeypatch.setattr(compiled, "threads", lambda: request.param)
    monkeypatch.setattr(compiled, "TERMS_PER_THREAD", 1)


def far_fields(count: int, kernel: sie.Kernel, rough: bool) -> list[np.ndarray]:
    """Fields of random intervals on distant intervals; the widths vary over four decades."""
    rng = np.random.default_rng(5)
    ends = np.cumsum(rng.uniform(0.1, 1.0, 2 * count) * 10.0 ** rng.uniform(-4, 0, 2 * count))
    a, b = np.reshape(ends / (1.1 * ends[-1]), (-1, 2)).T
    nested = Nested(Tree.over(a, b))
    return list(FarSum(nested, nested, kernel)(rng.normal(size=(count, TERMS)), rough))


@pytest.mark.parametrize("rough", [False, True])
@pytest.mark.parametrize("kernel", [sie.cauchy(), sie.hilbert(1.0)], ids=["line", "period"])
def test_far_fields_are_those_of_arrays(kernel, rough, threads, monkeypatch) -> None:
    monkeypatch.setattr(compiled, "MIN_TERMS", np.inf)
    wanted = far_fields(150, kernel, rough)
    monkeypatch.setattr(compiled, "MIN_TERMS", 0)
    found = far_fields(150, kernel, rough)
    for one, other in zip(found[:2], wanted[:2], strict=True):
        size = np.abs(other).max(axis=-1, keepdims=True)
        assert np.all(np.abs(one - other) <= 1e-13 * size)


@pytest.mark.parametrize("kernel", [sie.cauchy(), sie.hilbert(1.0)], ids=["line", "period"])
@pytest.mark.parametrize("symmetric", [False, True])
def test_near_fields_are_those_of_matrices(kernel, symmetric, threads, monkeypatch) -> None:
    """With all terms the fields agree to round-off. With `rough`, which sums only the terms for
    half of the digits, they agree to 1e-6.
    """
    rng = np.random.default_rng(6)
    ends = np.cumsum(10.0 ** rng.uniform(-3, 0, 60)).reshape(-1, 2) / 60
    table = np.concatenate((-ends[::-1, ::-1], ends)) if symmetric else ends
    zones = sie.Zones.of(table, symmetric=symmetric)
    m = rng.integers(0, 40, len(zones))
    m = np.maximum(m, m[::-1]) if symmetric else m
    equation = sie.Equation(kernel, lambda x: x, (sie.ZoneTotals(1.0),))
    layout = System(
        equation, zones, m, np.zeros((len(zones), m.max() + 1)), ForcingJumps.none()
    ).layout
    y = rng.normal(size=layout.size)
    monkeypatch.setattr(compiled, "MIN_TERMS", np.inf)
    wanted = ZoneSums(zones, kernel, layout).near.transform(y)
    monkeypatch.setattr(compiled, "MIN_TERMS", 0)
    sums = ZoneSums(zones, kernel, layout).near
    assert np.abs(sums.transform(y) - wanted).max() <= 1e-13 * np.abs(wanted).max()
    assert np.abs(sums.transform(y, rough=True) - wanted).max() <= 1e-6 * np.abs(wanted).max()


@pytest.mark.parametrize("terms", [[], [5], [1, 1, 1], [100, 0, 0, 0, 1], [0, 0, 7, 7]])
def test_threads_share_all_items(terms, threads) -> None:
    done = np.zeros(len(terms), dtype=int)

    def loop(begin: int, end: int, at: np.ndarray) -> None:
        at[begin:end] += 1

    compiled.in_threads(loop, np.concatenate(([0], np.cumsum(terms, dtype=int))), done)
    assert np.all(done == 1)


def test_an_error_in_a_thread_is_raised_and_settings_of_warnings_hold_there(threads) -> None:
    def loop(begin: int, end: int) -> None:
        np.log(np.zeros(1))
        if end == 40:
            raise MemoryError("the last part")

    with np.errstate(divide="ignore"), warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(MemoryError, match="the last part"):
            compiled.in_threads(loop, np.arange(41))
        compiled.in_threads(loop, np.arange(40))
    assert compiled.together([lambda: 1, lambda: 2]) == [1, 2]


@pytest.mark.parametrize(("asked", "most"), [("1", 1), ("", 10**6), ("nothing", 10**6)])
def test_omp_num_threads_limits_the_number_of_threads(asked, most, monkeypatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", asked)
    assert 1 <= compiled.threads() <= most


def test_without_numba_sums_are_left_to_arrays(monkeypatch) -> None:
    def missing(name: str) -> None:
        raise ImportError(name)

    compiled._loaded.cache_clear()
    monkeypatch.setattr(compiled.lazy, "module", missing)
    assert compiled.loops("tree_sums", np.inf) is None
    compiled._loaded.cache_clear()


@pytest.mark.parametrize("turn", [1.0, np.exp(0.7j)])
def test_power_series_are_those_of_arrays(turn, threads, monkeypatch) -> None:
    rng = np.random.default_rng(4)
    u, zone = rng.normal(size=(7, 40)), rng.integers(0, 7, 300)
    rho, terms = turn * rng.uniform(-1, 1, 300), rng.integers(0, 41, 300)
    monkeypatch.setattr(compiled, "MIN_TERMS", np.inf)
    wanted = sums._by_horner(u, rho, zone, terms)
    monkeypatch.setattr(compiled, "MIN_TERMS", 0)
    found = sums._by_horner(u, np.repeat(rho, 2)[::2], zone, terms)
    assert found.dtype == rho.dtype
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-13)
    assert len(sums._by_horner(u, rho[:0], zone[:0], terms[:0])) == 0


def test_densities_of_jumps_are_those_of_arrays(threads, monkeypatch) -> None:
    rng = np.random.default_rng(2)
    zones = sie.Zones.of([[-0.8, -0.1], [0.2, 0.2003], [0.4, 0.9]])
    at = np.concatenate((rng.uniform(-1, 1, 200), zones.a + 1e-9, zones.b - 1e-13, [0.2001]))
    jumps = ForcingJumps.within(
        zones, at, rng.normal(size=len(at)), rng.integers(0, 3, len(at)), None
    )
    zone = rng.integers(0, 3, 500)
    left = 2 * rng.beta(0.2, 0.2, 500)
    left[:3], zone[:3] = jumps.left[:3], jumps.zone[:3]
    monkeypatch.setattr(compiled, "MIN_TERMS", np.inf)
    wanted = jumps.density(zone, left, 2 - left)
    monkeypatch.setattr(compiled, "MIN_TERMS", 0)
    found = jumps.density(zone, left, 2 - left)
    # Arrays from `broadcast_arrays` and arrays with strides are copied before a loop, without a
    # warning.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        same = jumps.density(*np.broadcast_arrays(zone, 0.3, 1.7))
        stepped = jumps.density(zone, np.repeat(left, 2)[::2], 2 - left)
    assert np.array_equal(same, jumps.density(zone, np.full(500, 0.3), np.full(500, 1.7)))
    assert np.array_equal(stepped, found)
    assert np.array_equal(np.isinf(found), np.isinf(wanted))
    finite = np.isfinite(wanted)
    found, wanted = found[finite], wanted[finite]
    assert np.abs(found - wanted).max() <= 1e-13 * np.abs(wanted).max()
