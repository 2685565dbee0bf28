"""Built-in profiles declare their kinks and jumps, and no others, with the right sizes.
So a solve needs few evaluations of the profile at every load.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import contact
from contact import (
    Biquadratic,
    Flat,
    Fourier,
    Parabola,
    Polynomial,
    Profile,
    Sampled,
    Sinusoid,
    Wedge,
)
from contact.model.plugin_checks.jumps import jumps_at
from contact.model.profiles.tilted import Tilted

_POSITIONS = (0.0, 1.0, -100.0)  # of the first point of a trace, in lengths of the trace


def built_in(seed: int) -> Iterator[Profile]:
    """Every built-in profile, with and without a period, with random parameters of many sizes."""
    rng = np.random.default_rng(seed)
    length, steep = 10 ** rng.uniform(-6, 2), 10 ** rng.uniform(-4, 0)
    part, h = length * rng.uniform(0.02, 0.99), length / 2
    yield Sinusoid(steep * length, length)
    for period in (None, length):
        yield Wedge(steep, period)
        yield Parabola(length / steep, period)
        yield Biquadratic(length / steep, part, period)
        yield Flat(part, period)
    degree = int(rng.integers(2, 9))
    c = np.append(0, rng.standard_normal(degree)) * steep / h ** (np.arange(degree + 1) - 1.0)
    yield Polynomial(c)
    odd = np.arange(1, degree + 1, 2)
    c[1] -= np.sum(c[odd] * h ** (odd - 1.0))
    yield Polynomial(c, length)
    count = int(rng.integers(1, 200))
    yield Fourier(
        length,
        *(rng.standard_normal((2, count)) * np.arange(1, count + 1) ** -2.0 * steep * length),
    )
    count = int(rng.integers(12, 60))
    x = (
        length * (np.arange(count) + rng.uniform(-0.4, 0.4, count)) / count
        + length * _POSITIONS[seed % 3]
    )
    z = rng.standard_normal(count) * steep * length / count
    yield Sampled(x, z)
    yield Sampled(x, z, 1.1 * length)
    yield Sampled(length * np.arange(count) / count, z, length)


def places_of(profile: Profile) -> np.ndarray:
    border = [] if profile.period is None else [profile.x0]
    return np.unique(
        np.concatenate((border, profile.kinks[:, 0], profile.jumps[:, 0], profile.breakpoints))
    )


def assert_jumps_are_declared(profile: Profile) -> None:
    places = places_of(profile)
    ends = profile.support or profile.extent
    if ends is not None:
        places = places[(places > ends[0]) & (places < ends[1])]
    if not len(places):
        return
    around = (
        [places[-1] - profile.period, places[0] + profile.period]
        if profile.period
        else list(ends or (-np.inf, np.inf))
    )
    beside = np.diff(np.concatenate((around[:1], places, around[1:])))
    reach = 0.9 * np.minimum(
        np.minimum(beside[:-1], beside[1:]), 0.1 * (profile.period or profile.resolution or 1.0)
    )
    seen = jumps_at(profile, places, reach)
    declared = np.zeros((len(places), 3))
    for s, jump in profile.kinks:
        declared[places == s, 0] += jump
    for s, order, jump in profile.jumps:
        declared[places == s, int(order) - 1] += jump
    size = np.abs(profile.slope(places[:, None] + reach[:, None] * np.linspace(-1, 1, 20))).max(
        axis=1
    )
    for order in (1, 2, 3):
        # The unit is the size of the derivative whose jumps are compared: the slope over a
        # power of `reach`, plus the declared jump. The allowed errors are far below it.
        unit = size / reach ** (order - 1) + np.abs(declared[:, order - 1])
        assert np.all(seen.doubt[:, order - 1] <= 1e-4 * unit)
        assert np.all(
            np.abs(seen.height - declared)[:, order - 1]
            <= 10 * seen.doubt[:, order - 1] + 1e-9 * unit
        )


@pytest.mark.parametrize("seed", range(6))
def test_a_built_in_profile_jumps_where_it_says_and_nowhere_else_it_could(seed: int) -> None:
    for profile in built_in(seed):
        assert_jumps_are_declared(profile)
        assert_jumps_are_declared(Tilted(profile, 0.1))


def test_a_jump_left_out_or_wrong_by_a_thousandth_is_detected() -> None:
    """A profile that omits its jumps, or declares them wrong by 1e-3, fails the test above."""
    for factor in (0.0, 1.001):

        class Off(Biquadratic):
            @property
            def jumps(self, factor=factor):
                return super().jumps * [1, 1, factor]

        with pytest.raises(AssertionError):
            assert_jumps_are_declared(Off(1e-3, 4e-5, 1e-4))


@pytest.mark.parametrize("pressure", [2e6, 5e6, 1e7, 2e7, 4e7, 6e7])
def test_the_paper_s_two_tips_take_little_work_at_every_load(
    pressure: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    places = 0
    slope = Biquadratic.slope

    def counted(self, x):
        nonlocal places
        places += np.size(x)
        return slope(self, x)

    monkeypatch.setattr(Biquadratic, "slope", counted)
    solution = contact.solve(
        contact.Scene(
            Biquadratic(1e-3, 4e-5, 1e-4), 1e10, contact.Periodic(), mean_pressure=pressure
        )
    )
    assert solution.certificate.holds and solution.error <= 1e-8
    assert (
        places <= 3000
        and solution.plan.counts["own_modes"] <= 96
        and solution.plan.counts["solves"] <= 12
    )
