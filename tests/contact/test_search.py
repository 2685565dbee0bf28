"""Contact on a grid and its zones: closed forms, complementarity, controls, iteration counts."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import contact
from contact import inverse
from contact.errors import OutOfRange
from contact.search.grid import nested_grids, proposals
from contact.search.grid.conjugate_gradient import GridState, Influence, Response, solve_grid
from contact.search.grid.fourier import FourierMultiplier, FourierTable
from contact.search.grid.nested_grids import find_window, narrowest, propose, zones_of
from contact.search.grid.scaling import scaled_scene
from contact.search.topology.intervals import NARROW, merged
from contact.studies.trace_kinds import drawn
from tests.tiers import diagonal

Array = NDArray[np.float64]
Shape = Callable[[Array], Array]
E = 2.0
CELL = (-0.5, 0.5)


@pytest.fixture
def nested(monkeypatch: pytest.MonkeyPatch) -> list[GridState]:
    """The states of all grids that are solved, in their order."""
    found: list[GridState] = []

    def kept(*arguments: Any, **options: Any) -> GridState:
        found.append(solve_grid(*arguments, **options))
        return found[-1]

    monkeypatch.setattr(nested_grids, "solve_grid", kept)
    return found


def iterations(nested: list[GridState]) -> int:
    """Iterations on all grids since the last count."""
    count = sum(state.iterations for state in nested)
    nested.clear()
    return count


def midpoints(n: int, cell: tuple[float, float] = CELL) -> Array:
    return np.asarray(cell[0] + (cell[1] - cell[0]) * (np.arange(n) + 0.5) / n)


def sinusoid(at: float = 0.0) -> Shape:
    return lambda x: 1.0 - np.cos(2.0 * np.pi * (x - at))


def westergaard_load(a: float) -> float:
    """The mean pressure pi E Delta / L sin^2(pi a / L) for Delta = L = 1 (Johnson 1985, 13.7)."""
    return float(np.pi * E * np.sin(np.pi * a) ** 2)


def hertz_load(a: float, radius: float) -> float:
    return np.pi * E * a**2 / (4.0 * radius)


def hertz_level(a: float, radius: float, datum: float) -> float:
    """u(0) under the Hertz pressure with the datum d: (2P / pi E) (ln(2d/a) + 1/2).

    It is -(2P / pi E) times the mean of ln|x/d|, weighted with the pressure.
    """
    return float(2.0 * hertz_load(a, radius) / (np.pi * E) * (np.log(2.0 * datum / a) + 0.5))


def rough(waves: int, seed: int, hurst: float = 0.8) -> Shape:
    """Self-affine heights with random phases: amplitudes k^-(H + 1/2), cut off at k = waves."""
    rng = np.random.default_rng(seed)
    k = np.arange(1, waves + 1)
    amplitude, phase = k ** -(hurst + 0.5), 2.0 * np.pi * rng.random(waves)

    def height(x: Array) -> Array:
        n = len(x)
        spectrum = np.zeros(n // 2 + 1, dtype=complex)
        kept = k <= n // 2  # coarse grids have only the long waves
        shift = 2.0 * np.pi * k[kept] * x[0]
        spectrum[k[kept]] = 0.5 * n * amplitude[kept] * np.exp(1j * (phase[kept] + shift))
        return np.asarray(np.fft.irfft(spectrum, n))

    return height


def end_errors(n: int, a: float, periodic: bool) -> float:
    """The largest end error over several positions of the tip within a cell of the grid.

    The error is exceptionally small if the tip is at a grid point.
    """
    h, x, worst = 1.0 / n, midpoints(n), 0.0
    for offset in np.linspace(0.0, 1.0, 7):
        at = offset * h
        if periodic:
            state = solve_grid(
                sinusoid(at)(x), Influence.periodic(n, h, E), load=westergaard_load(a)
            )
        else:
            state = solve_grid(
                (x - at) ** 2 / 2.0, Influence.isolated(n, h, E), load=hertz_load(a, 1.0)
            )
        zones = zones_of(state, x)
        assert zones.shape == (1, 2)
        worst = max(worst, float(np.max(np.abs(zones - [[at - a, at + a]]))))
    return worst


def assert_complementary(state: GridState, tol: float = 1e-5) -> None:
    p, h = state.pressure, state.influence.h
    peak = p.max()
    touch = state.contact
    assert state.converged
    assert np.all(p >= 0.0)
    assert p.sum() * h == pytest.approx(state.load, rel=1e-12)
    gap = state.influence.apply(p) + state.f - state.level
    seen = np.isfinite(state.f)
    assert np.allclose(gap[seen], state.gap[seen], atol=1e-12 * np.ptp(state.f[seen]))
    # An error of tol * peak in the pressure of each cell changes the displacement by this much. The
    # sum over all cells grows as the logarithm of their number.
    slack = tol * peak * h / E * np.log2(len(p))
    assert gap[~touch & seen].min(initial=0.0) >= -slack
    assert np.abs(gap[touch]).max() <= slack * 10


@pytest.mark.parametrize("periodic", [True, False])
def test_zone_ends_of_sinusoid_and_parabola_converge_linearly_in_the_cell(periodic: bool) -> None:
    sizes = np.array([64, 128, 256, 512, 1024])
    errors = np.array([end_errors(int(n), 0.2, periodic) for n in sizes])
    assert np.all(errors < 0.4 / sizes)
    rate = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert -1.35 < rate < -0.8


def test_a_wrong_load_is_seen_in_the_zone_ends() -> None:
    x = midpoints(1024)
    state = solve_grid(
        sinusoid()(x), Influence.periodic(1024, 1 / 1024, E), load=1.05 * westergaard_load(0.2)
    )
    assert abs(zones_of(state, x)[0, 1] - 0.2) > 4 / 1024


def test_the_grid_gives_the_hertz_pressure_and_approach() -> None:
    n, a, radius = 2048, 0.2, 1.5
    x = midpoints(n)
    influence = Influence.isolated(n, 1 / n, E, datum=3.0)
    state = solve_grid(x**2 / (2 * radius), influence, load=hertz_load(a, radius))
    exact = E / (2 * radius) * np.sqrt(np.maximum(a**2 - x**2, 0.0))
    assert np.max(np.abs(state.pressure - exact)) < 0.1 * exact.max() * np.sqrt(
        1 / (n * a)
    )  # p ~ sqrt(d) at the ends
    assert state.level == pytest.approx(hertz_level(a, radius, 3.0), rel=1e-5)


def test_the_isolated_influence_of_a_uniform_pressure_is_the_closed_logarithmic_integral() -> None:
    n, length = 256, 3.0
    x = midpoints(n, (0.0, length))
    u = Influence.isolated(n, length / n, E).apply(np.ones(n))
    left, right = x, length - x
    exact = -2.0 / (np.pi * E) * (left * np.log(left) + right * np.log(right) - length)
    assert np.allclose(u, exact, atol=1e-12)


@pytest.mark.parametrize(
    "size", [7, 12, 5001, 1 << 14, 150_001, 150_002, 150_000, 9 << 14, 7 << 17]
)
@pytest.mark.parametrize("threads", ["1", "3"])
def test_factors_of_waves_act_like_one_long_transform(
    size: int, threads: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", threads)
    rng = np.random.default_rng(size)
    factors, values = rng.standard_normal(size // 2 + 1), rng.standard_normal(size)
    for given in (values, values[: size // 2]):
        wanted = np.fft.irfft(np.fft.rfft(given, size) * factors, size)
        for kind, digits in ((np.float64, 1e-14), (np.float32, 1e-5)):
            found = FourierMultiplier(FourierTable(size, kind), factors)(given.astype(kind))
            assert found.dtype == kind and found.shape == (size,)
            assert np.abs(found - wanted).max() < digits * np.abs(wanted).max()


@pytest.mark.parametrize("at", [0.45, -0.48, 0.5])
def test_a_zone_across_the_border_is_listed_once_by_its_left_end(at: float) -> None:
    found = propose(sinusoid(at), CELL, Response(E), load=westergaard_load(0.1), resolution=1.0)
    assert found.zones.shape == (1, 2)
    left, right = found.zones[0]
    assert CELL[0] <= left < CELL[1]
    assert right - left == pytest.approx(0.2, abs=2 / found.points)
    assert np.cos(2 * np.pi * (0.5 * (left + right) - at)) == pytest.approx(1.0, abs=1e-4)


def test_a_biquadratic_touches_at_two_tips_and_in_one_zone_under_a_heavier_load() -> None:
    def height(x: Array) -> Array:
        return x**4 / 8.0 - x**2 / 4.0

    light = find_window(height, Response(E, False), load=0.02)
    two = propose(height, light, Response(E, False), load=0.02)
    assert two.zones.shape == (2, 2)
    assert np.allclose(two.zones, -two.zones[::-1, ::-1], atol=1e-9)
    a, b = two.zones[1]
    assert a**2 + b**2 == pytest.approx(2.0, abs=8 / two.points)  # exact by equation (38), isolated
    heavy = find_window(height, Response(E, False), load=2.0)
    assert propose(height, heavy, Response(E, False), load=2.0).zones.shape == (1, 2)


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("load", [1e-3, 0.3, 3.0, 12.0])
def test_a_rough_contact_is_complementary_and_carries_its_load(seed: int, load: float) -> None:
    found = propose(
        rough(60, seed), CELL, Response(E), load=load, resolution=1 / 60, max_points=2**13
    )
    assert_complementary(found.state)
    zones = found.zones
    assert np.all(zones[:, 1] > zones[:, 0])
    assert np.all(zones[1:, 0] > zones[:-1, 1])
    assert zones[-1, 1] < zones[0, 0] + 1.0
    # each run of contact cells is one zone
    touch = found.state.contact
    assert len(zones) == np.count_nonzero(touch & ~np.roll(touch, 1))


def test_the_contact_does_not_depend_on_the_start() -> None:
    n = 1024
    f = rough(100, 3)(midpoints(n))
    influence = Influence.periodic(n, 1 / n, E)
    reference = solve_grid(f, influence, load=1.0, tol=1e-10)
    rng = np.random.default_rng(0)
    for start in (rng.random(n), (np.arange(n) == 5).astype(float), rng.random(n) < 0.1):
        other = solve_grid(f, influence, load=1.0, start=start, tol=1e-10)
        assert np.array_equal(other.contact, reference.contact)
        assert np.allclose(other.pressure, reference.pressure, atol=1e-8 * reference.pressure.max())


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize("load", [1e-3, 0.3, 3.0])
def test_level_control_inverts_load_control(periodic: bool, load: float) -> None:
    n = 1024
    x = midpoints(n)
    f = rough(50, 4)(x) if periodic else 10.0 * x**2 + 0.02 * np.cos(60 * x)
    influence = (
        Influence.periodic(n, 1 / n, E) if periodic else Influence.isolated(n, 1 / n, E, datum=2.0)
    )
    loaded = solve_grid(f, influence, load=load, tol=1e-9)
    levelled = solve_grid(f, influence, level=loaded.level, tol=1e-9)
    assert levelled.converged
    assert levelled.load == pytest.approx(load, rel=1e-7)
    assert np.array_equal(levelled.contact, loaded.contact)


def test_the_compliance_under_level_control_is_the_slope_of_the_level() -> None:
    n = 512
    f = sinusoid()(midpoints(n))
    influence = Influence.periodic(n, 1 / n, E)
    state = solve_grid(f, influence, level=0.5, tol=1e-9)
    step = 1e-5 * state.load
    above = solve_grid(f, influence, load=state.load + step, tol=1e-11)
    below = solve_grid(f, influence, load=state.load - step, tol=1e-11)
    assert (above.level - below.level) / (2 * step) == pytest.approx(state.compliance, rel=1e-3)


def test_a_level_below_the_profile_is_no_contact_and_one_above_its_mean_is_refused() -> None:
    n = 128
    f = sinusoid()(midpoints(n))
    influence = Influence.periodic(n, 1 / n, E)
    apart = solve_grid(f, influence, level=-0.1)
    assert apart.load == 0.0 and not np.any(apart.contact) and np.allclose(apart.gap, f + 0.1)
    with pytest.raises(OutOfRange):
        solve_grid(f, influence, level=1.01)


def test_an_approach_past_its_isolated_maximum_is_refused() -> None:
    n = 512
    x = midpoints(n, (-4.0, 4.0))
    influence = Influence.isolated(n, 8 / n, E, datum=1.0)
    largest = hertz_level(2.0, 1.0, 1.0)  # the maximum for Hertz, at a = 2 datum
    state = solve_grid(x**2 / 2.0, influence, level=0.98 * largest)
    assert state.load < hertz_load(2.0, 1.0)
    with pytest.raises(OutOfRange):
        solve_grid(x**2 / 2.0, influence, level=1.01 * largest)


def test_full_contact_is_recognized_and_has_no_gap_and_no_ends() -> None:
    found = propose(sinusoid(), CELL, Response(E), load=1.1 * np.pi * E, resolution=1.0)
    assert found.full and narrowest(found.state) >= NARROW
    assert found.zones.shape == (0, 2)
    assert np.max(np.abs(found.state.gap)) < 1e-12
    x = midpoints(found.points)
    assert np.allclose(found.state.pressure, np.pi * E * (1.1 + np.cos(2 * np.pi * x)), atol=1e-10)


@pytest.mark.parametrize("gap", [1e-2, 1e-3, 2e-4])
def test_a_small_gap_is_not_taken_for_full_contact(gap: float) -> None:
    found = propose(
        sinusoid(), CELL, Response(E), load=westergaard_load(0.5 - gap / 2), resolution=1.0
    )
    assert not found.full
    assert 1.0 - (found.zones[0, 1] - found.zones[0, 0]) == pytest.approx(
        gap, abs=2.0 / found.points
    )


@pytest.mark.parametrize("a", [1e-2, 1e-3, 1e-4, 1e-6])
def test_small_zones_are_found_by_refinement_and_smaller_ones_by_hertz(a: float) -> None:
    found = propose(sinusoid(), CELL, Response(E), load=westergaard_load(a), resolution=1.0)
    assert (narrowest(found.state) >= NARROW) == (a > 1e-5)
    assert np.allclose(found.zones, [[-a, a]], rtol=0.0, atol=0.3 * a)


@pytest.mark.parametrize("offset", [0.0, 0.25, 0.5])
@pytest.mark.parametrize("part", [0.1, 0.25, 0.4])
def test_a_gap_narrower_than_a_cell_is_found(part: float, offset: float) -> None:
    """Just before the two zones of a biquadratic merge, their gap is narrower than a cell.

    The gap has the half width a, and a^2 + b^2 = 2 by equation (38) for isolated contact.
    """
    n, window = 256, (-4.0, 4.0)
    x, h = midpoints(n, window), 8.0 / n
    a, at = part * h, offset * h
    f = (x - at) ** 4 / 8.0 - (x - at) ** 2 / 4.0
    influence = Influence.isolated(n, h, E)
    state = solve_grid(f, influence, load=np.pi * E * (2.0 - 2.0 * a**2) ** 2 / 32.0)
    zones = zones_of(state, x, between_points=True)
    assert zones.shape == (2, 2)
    assert -1.25 * h < zones[0, 1] - at < zones[1, 0] - at < 1.25 * h
    merged = solve_grid(f, influence, load=1.02 * np.pi * E / 8.0)
    assert zones_of(merged, x, between_points=True).shape == (1, 2)


@pytest.mark.parametrize("excess", [1e-4, 2e-4, 3e-4])
@pytest.mark.parametrize("offset", np.arange(8) / 8)
def test_a_zone_narrower_than_a_cell_is_found_in_its_place(
    offset: float, excess: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A profile of three harmonics just above the load at which its second zone begins."""
    few = dataclasses.replace(nested_grids.OPTIONS, many_features=0)
    monkeypatch.setattr(nested_grids, "OPTIONS", few)
    period, E, load = 1e-4, 1e11, 158222.1 * (1 + excess)
    tips = contact.Fourier(period, [-1e-6, -0.3e-6, 0.2e-6], [0.1e-6, 0.25e-6, 0.0])
    zone = contact.solve(contact.Scene(tips, E, contact.Periodic(), load=load)).zones[1]
    h = period / 256
    assert 0.2 * h < np.diff(zone)[0] < 0.6 * h
    left = -0.5 * period + offset * h
    found = propose(
        tips.height,
        (left, left + period),
        Response(E),
        load=load,
        resolution=period / 32,
        max_points=256,
    )
    assert found.points == 256 and len(found.zones) == 2
    assert abs(found.zones[1].mean() - zone.mean()) < 0.15 * h
    assert 0.5 < np.diff(found.zones[1])[0] / np.diff(zone)[0] < 2.0


def test_a_gap_narrower_than_a_cell_is_found_wherever_a_period_begins() -> None:
    n = 512
    x = midpoints(n)
    f = 0.1 * np.cos(2 * np.pi * x) - 0.05 * np.cos(6 * np.pi * x)
    for shift in range(0, n, 64):
        zones = zones_of(
            solve_grid(np.roll(f, shift), Influence.periodic(n, 1 / n, 1.0), load=0.2),
            x,
            between_points=True,
        )
        assert len(zones) == 3
        # A grid of 4,096 points gives the gap the half width 0.00083.
        from_gap = (zones - shift / n) % 1.0 - 0.5
        assert np.abs(from_gap).min() == pytest.approx(0.00083, abs=2e-4)


def test_points_outside_the_support_never_touch_and_sharp_ends_keep_their_place() -> None:
    n = 1024
    x = midpoints(n)
    f = np.where(np.abs(x) < 0.25, 0.0, np.inf)
    state = solve_grid(f, Influence.isolated(n, 1 / n, E), load=1.0)
    assert np.array_equal(state.contact, np.isfinite(f))
    assert np.all(np.isinf(state.gap[~state.contact]))
    assert np.allclose(zones_of(state, x), [[-0.25, 0.25]], atol=1e-12)
    inner = np.abs(x) < 0.2
    assert np.allclose(
        state.pressure[inner], 1.0 / (np.pi * np.sqrt(0.25**2 - x[inner] ** 2)), rtol=5e-3
    )


@pytest.mark.parametrize("load", [0.3, 3.0])
def test_iterations_on_a_rough_profile_do_not_grow_with_the_grid(
    load: float, nested: list[GridState]
) -> None:
    """The profile for each grid is as rough as the grid resolves.

    The iterations on all nested grids are counted.
    """
    counts = []
    for n in (2**10, 2**12, 2**14):
        found = propose(rough(n // 16, 7), CELL, Response(E), load=load, points=n)
        assert found.points == n and found.state.converged
        counts.append(iterations(nested) / np.log2(n))
    assert counts[-1] < 25
    assert counts[-1] < 2.0 * counts[0]


def test_the_work_without_a_start_is_bounded_on_a_rough_profile_of_16384_points() -> None:
    n = 2**14
    state = solve_grid(rough(n // 16, 8)(midpoints(n)), Influence.periodic(n, 1 / n, E), load=1.0)
    assert_complementary(state)
    assert state.iterations < 300


def flat_with_needles(n: int) -> Array:
    """A flat top on 0.7 of the period, with twelve needles of one cell on it."""
    rng, beside = np.random.default_rng(1), np.abs(midpoints(n)) - 0.35
    f = 1e-2 * np.maximum(beside, 0.0)
    f[rng.choice(np.flatnonzero(beside < 0.0), 12, replace=False)] -= 1e-5 * rng.uniform(
        0.5, 1.0, 12
    )
    return np.asarray(f)


@pytest.mark.parametrize(
    ("load", "tol", "periodic"), diagonal([1e-4, 2e-5, 1e-5], [1e-3, 1e-5], [True, False])
)
def test_a_flat_top_with_needles_converges_in_few_iterations_from_any_start(
    load: float, tol: float, periodic: bool
) -> None:
    n = 2**15
    f, influence = (
        flat_with_needles(n),
        (Influence.periodic if periodic else Influence.isolated)(n, 1 / n, 1.0),
    )
    exact = solve_grid(f, influence, load=load, tol=1e-9).pressure
    heavier = solve_grid(f, influence, load=10 * load, tol=tol).pressure
    for start in (None, heavier):
        state = solve_grid(f, influence, load=load, tol=tol, start=start)
        assert state.converged
        assert state.iterations < 140
        assert np.linalg.norm(state.pressure - exact) < 10 * tol * np.linalg.norm(exact)


@pytest.mark.parametrize(("seed", "fraction"), [(1, 0.05), (4, 0.02), (7, 0.005), (10, 0.02)])
def test_of_the_finest_grids_the_one_nearest_to_the_given_fraction_is_proposed(
    seed: int, fraction: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried: list[nested_grids.Proposal] = []

    def kept(*arguments: Any, **options: Any) -> nested_grids.Proposal:
        tried.append(proposed(*arguments, **options))
        return tried[-1]

    proposed = proposals.proposed
    monkeypatch.setattr(proposals, "proposed", kept)
    profile = drawn(np.random.default_rng(seed), "wear_flats", 500)
    scene = contact.Scene(
        profile, E_star=2e11, interaction=contact.Periodic(), contact_fraction=fraction
    )
    scaled = scaled_scene(scene, single=False)
    found = proposals.of_width(scaled, scaled.control.value)
    assert profile.period is not None
    finest = [each for each in tried if each.points == found.points]
    assert found.points == max(each.points for each in tried)
    fractions = np.array([each.width for each in (found, *finest)]) / profile.period
    misses = np.abs(np.log(fractions / (1.0 - fractions)) - np.log(fraction / (1.0 - fraction)))
    assert misses[0] == misses[1:].min()


@pytest.mark.parametrize("radius", [1e-9, 1e-3, 1e6])
@pytest.mark.parametrize("load", [1e-14, 1e-7, 1.0, 1e6])
def test_a_window_is_found_around_a_parabola_of_any_scale(radius: float, load: float) -> None:
    a = 2.0 * np.sqrt(radius * load / (np.pi * E))
    low, high = find_window(lambda x: x**2 / (2 * radius), Response(E, False), load=load)
    assert low < -a and a < high
    assert 0.15 < 2 * a / (high - low) < 0.8
    found = propose(lambda x: x**2 / (2 * radius), (low, high), Response(E, False), load=load)
    assert np.allclose(found.zones, [[-a, a]], rtol=0.0, atol=0.05 * a)
    assert not found.touches_border


@pytest.mark.parametrize("slope", [1e-6, 1.0])
@pytest.mark.parametrize("load", [1e-12, 1.0, 1e6])
def test_a_window_is_found_around_a_wedge(slope: float, load: float) -> None:
    a = load / (E * slope)  # the wedge's mean pressure E slope / 2
    low, high = find_window(lambda x: slope * np.abs(x), Response(E, False), load=load)
    found = propose(lambda x: slope * np.abs(x), (low, high), Response(E, False), load=load)
    assert 0.15 < 2 * a / (high - low) < 0.8
    assert np.allclose(found.zones, [[-a, a]], rtol=0.0, atol=0.05 * a)


@pytest.mark.parametrize(
    "height",
    [
        lambda x: (x - 1e3) ** 2,
        lambda x: x**4 / 8e-12 - x**2 / 4.0,
        lambda x: x**6 + 0.3 * x**3 - x,
        lambda x: 1e-3 * (x + 7.0) ** 2 - 4.0,
    ],
)
@pytest.mark.parametrize("load", [1e-8, 1.0, 1e4])
def test_a_window_is_found_around_a_polynomial(height: Shape, load: float) -> None:
    window = find_window(height, Response(E, False), load=load)
    found = propose(height, window, Response(E, False), load=load)
    assert not found.touches_border
    extent = found.zones[-1, 1] - found.zones[0, 0]
    assert 0.1 < extent / (window[1] - window[0]) < 0.8


@pytest.mark.parametrize("datum", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("ratio", [1e-4, 0.1, 1.9])
def test_a_window_is_found_from_the_approach(datum: float, ratio: float) -> None:
    a, radius = ratio * datum, 10.0
    level = hertz_level(a, radius, datum)

    def height(x: Array) -> Array:
        return x**2 / (2 * radius)

    window = find_window(height, Response(E, False, datum=datum), level=level)
    found = propose(height, window, Response(E, False, datum=datum), level=level)
    assert np.allclose(found.zones, [[-a, a]], rtol=0.0, atol=0.05 * a)


def test_a_window_keeps_to_its_limits_and_a_contact_that_reaches_them_is_reported() -> None:
    limits = (-1.0, 1.0)
    assert find_window(lambda x: x**2 / 2, Response(E, False), load=10.0, limits=limits) == limits
    assert propose(lambda x: x**2 / 2, limits, Response(E, False), load=10.0).touches_border
    nearly = hertz_load(0.85, 1.0)
    assert find_window(lambda x: x**2 / 2, Response(E, False), load=nearly, limits=limits) == limits
    low, high = find_window(lambda x: x**2 / 2, Response(E, False), load=1e-6, limits=limits)
    assert -1.0 < low < 0.0 < high < 1.0


def test_a_search_that_starts_beyond_the_limits_looks_within_them_only() -> None:
    limits = (0.0, 3.0)

    def known(x: Array) -> Array:
        return np.where((x >= limits[0]) & (x <= limits[1]), (x - 0.1) ** 2, np.nan)

    window = find_window(
        known, Response(E, periodic=False), load=1e-4, limits=limits, start=(-0.4, 0.6)
    )
    assert limits[0] <= window[0] < 0.1 < window[1] <= limits[1]


def test_a_profile_without_a_bottom_is_refused() -> None:
    with pytest.raises(OutOfRange):
        find_window(lambda x: x**3, Response(E, False), load=1.0)


def test_a_grid_beside_a_known_contact_proposes_the_same_zones_in_fewer_iterations(nested):
    def height(x):
        return -np.cos(2 * np.pi * x) - 0.1 * np.cos(14 * np.pi * x)

    response = Response(1.0, True)
    known = propose(height, (0.0, 1.0), response, load=1.0, points=1024)
    nested.clear()
    alone = propose(height, (0.0, 1.0), response, load=1.001, points=1024)
    of_alone = iterations(nested)
    beside = propose(height, (0.0, 1.0), response, load=1.001, points=1024, start=known.state)
    np.testing.assert_allclose(beside.zones, alone.zones, rtol=0, atol=1e-6)
    assert iterations(nested) < of_alone


def test_zones_outside_the_first_window_of_isolated_contact_are_found():
    shape = inverse.random_adhesive_problem(
        np.random.default_rng(2209), 6, pull=1e-3, E_star=1.0
    ).profile
    solution = contact.solve(contact.Scene(shape, 1.0, contact.Isolated(), load=0.05))
    # The first window begins at -0.66.
    assert solution.certificate.holds and len(solution.zones) == 5 and solution.zones[0, 1] < -0.75


def test_zones_that_meet_across_the_border_and_within_the_cell_at_once_become_one() -> None:
    zones = np.array([[0.0, 1.0], [2.0, 3.0], [4.0, 5.0], [6.0, 7.0]])
    joined = merged(
        zones, np.array([2, 3]), 8.0
    )  # the gap from 5 to 6, and that from 7 to 8, where the first zone begins again
    assert joined.tolist() == [[2.0, 3.0], [4.0, 9.0]]
    assert merged(zones, np.array([0, 3]), None).tolist() == [[0.0, 3.0], [4.0, 5.0], [6.0, 7.0]]
