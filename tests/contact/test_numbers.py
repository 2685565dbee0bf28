"""The numbers of a solution, against quadrature of its fields, differences, and other solutions."""

from __future__ import annotations

import numpy as np
import pytest

import contact
from contact.reference import exact
from contact.reference.inverse import random_problem
from contact.search.strategies.gaps import GapOptions
from contact.solution.report import Errors
from tests.contact import numbers

PERIODIC = contact.Periodic()
_random = np.random.default_rng(5)


def trace(count, uneven=0.0, seed=5):
    """A periodic self-affine trace of `count` points. uneven: largest shift of a point in steps."""
    rng = np.random.default_rng(seed)
    k = np.arange(1, count // 2)
    spectrum = np.zeros(count // 2 + 1, dtype=complex)
    spectrum[1 : count // 2] = (
        rng.normal(size=k.size) + 1j * rng.normal(size=k.size)
    ) * np.maximum(k, 6.0) ** -1.3
    z = np.fft.irfft(spectrum, count)
    return contact.Sampled(
        (np.arange(count) + uneven * rng.uniform(-1, 1, count)) / count,
        0.05 * z / np.ptp(z) / 6,
        1.0,
    )


WAVES = contact.Fourier(1.0, *(0.01 * _random.normal(size=(2, 12)) * np.arange(1, 13) ** -1.3))
ROUGH, UNEVEN = trace(64), trace(40, uneven=0.3)
# (profile, share of the load of full contact): few zones, many zones, and contacts solved by their
# gaps. Profiles with kinks have no full contact: their second number is the mean pressure in units
# of E*.
SCENES = [
    *((WAVES, share) for share in (0.1, 0.5, 0.9, 0.999)),
    *((ROUGH, share) for share in (0.05, 0.3, 0.6, 0.95)),
    *((UNEVEN, share) for share in (0.2, 0.8)),
    *((contact.Biquadratic(1.0, 0.4, 1.0), pressure) for pressure in (1e-3, 1e-2, 2e-2)),
    *((contact.Wedge(0.1, 1.0), pressure) for pressure in (1e-2, 0.1, 0.2)),
    *((contact.Parabola(1.0, 1.0), pressure) for pressure in (1e-2, 0.3)),
    *((contact.Polynomial([0, -1.0, 1.0, 1.0], 2.0), pressure) for pressure in (1e-2, 0.5, 2.0)),
]
LONE = [
    contact.Parabola(1.0),
    contact.Wedge(0.1),
    contact.Polynomial([0, 0, 1.0, 0.5, 2.0]),
    contact.Biquadratic(1.0, 0.4),
]


def pressure_of(profile, share):
    kinked = len(profile.kinks) > 0
    return share if kinked else share * full_load(profile) / profile.period


_full: dict[int, float] = {}


def full_load(profile):
    if id(profile) not in _full:
        _full[id(profile)] = contact.solve(
            contact.Scene(profile, 1.0, PERIODIC, contact_fraction=1.0)
        ).load
    return _full[id(profile)]


def solved(profile, share, change=0.0, model=PERIODIC):
    return contact.solve(
        contact.Scene(
            profile, 1.0, model, mean_pressure=(1 + change) * pressure_of(profile, share)
        ),
        tol=1e-9,
    )


def unit_of(solution):
    finite = np.isfinite(solution.max_pressure)
    return solution.max_pressure if finite else solution.load / solution.zone_widths.sum()


def names(value):
    return getattr(value, "name", None)


@pytest.mark.parametrize(("profile", "share"), SCENES, ids=names)
def test_loads_and_mean_gap_and_approach_are_those_of_the_fields(profile, share):
    solution = solved(profile, share)
    unit, rounding = unit_of(solution), 1e-13
    loads = numbers.zone_loads(solution)
    assert solution.zone_loads.sum() == pytest.approx(solution.load, rel=rounding)
    # The bounds are those of docs/errors.md.
    assert np.all(
        np.abs(solution.zone_loads - loads)
        <= 3 * (solution.error + rounding) * unit * solution.zone_widths
    )
    length = 3 * (solution.error + rounding) * unit * profile.period
    assert abs(solution.mean_gap - numbers.mean_gap(solution)) <= length
    lo, hi = max(numbers.open_intervals(solution), key=lambda ends: ends[1] - ends[0])
    assert (
        abs(solution.approach - numbers.approach(solution, np.float64(lo + 0.37 * (hi - lo))))
        <= length
    )
    samples = solution.pressure(
        profile.x0 + profile.period * np.random.default_rng(0).uniform(0, 1, 4000)
    )
    assert samples.max() <= (1 + solution.error) * solution.max_pressure
    assert solution.contact_fraction == pytest.approx(
        solution.zone_widths.sum() / profile.period, rel=1e-12
    )


@pytest.mark.parametrize(
    ("profile", "share"),
    [
        pytest.param(*scene, marks=[pytest.mark.slow] * (scene == (ROUGH, 0.3)))
        for scene in SCENES[1::2]
    ],
    ids=names,
)
def test_the_stiffness_is_the_derivative_of_the_load_by_the_approach(profile, share):
    # Richardson: the difference to the quotient over twice the step bounds the error of the
    # quotient over one step.
    near, far = (_gain(profile, share, h) for h in (1e-3, 2e-3))
    assert abs(near - solved(profile, share).stiffness) <= abs(far - near) + 1e-5 * near


def _gain(profile, share, h):
    more, less = (solved(profile, share, change) for change in (h, -h))
    return (more.load - less.load) / (more.approach - less.approach)


@pytest.mark.parametrize("profile", LONE, ids=names)
def test_numbers_of_a_lone_body_are_those_of_its_pressure(profile):
    model = contact.Isolated(datum=3.0)
    near, here, far = (
        contact.solve(contact.Scene(profile, 1.0, model, load=p), tol=1e-10)
        for p in (0.999e-2, 1e-2, 1.001e-2)
    )
    loads, unit = numbers.zone_loads(here), unit_of(here)
    assert here.zone_loads.sum() == pytest.approx(here.load, rel=1e-14)
    assert np.all(
        np.abs(here.zone_loads - loads) <= 3 * (here.error + 1e-13) * unit * here.zone_widths
    )
    assert abs(here.moment - numbers.moment(here)) <= 3 * (
        here.error + 1e-13
    ) * unit * here.zone_widths.sum() * np.ptp(here.zones)
    outside = here.zones[-1, 1] + 0.3 * here.zone_widths[-1]
    assert here.approach == pytest.approx(numbers.approach(here, outside), rel=1e-9)
    assert (far.load - near.load) / (far.approach - near.approach) == pytest.approx(
        here.stiffness, rel=1e-5
    )


@pytest.mark.parametrize("closure", ["first-order", "self-consistent"])
def test_numbers_of_a_localized_strip_are_those_of_its_pressure(closure):
    wave = contact.Sinusoid(1e-3, 1.0)
    near, here, far = (
        contact.solve(contact.Scene(wave, 1.0, contact.Localized(closure), load=p))
        for p in (0.999e-3, 1e-3, 1.001e-3)
    )
    assert numbers.zone_loads(here) == pytest.approx(here.zone_loads, rel=here.error + 1e-13)
    assert here.zone_loads.sum() == pytest.approx(here.load, rel=1e-14)
    assert (far.load - near.load) / (far.approach - near.approach) == pytest.approx(
        here.stiffness, rel=1e-5
    )


@pytest.mark.parametrize(
    ("profile", "share"), [(WAVES, 0.6), (ROUGH, 0.6), (contact.Parabola(1.0, 1.0), 0.2)], ids=names
)
def test_solutions_by_zones_and_by_gaps_have_the_same_numbers(profile, share, monkeypatch):
    monkeypatch.setattr("contact.solver.solve_closed", lambda scene, tol: None)
    by_gaps = solved(profile, share)
    monkeypatch.setattr("contact.search.strategies.gaps.OPTIONS", GapOptions(wide_contact=2.0))
    by_zones = solved(profile, share)
    assert [s.certificate.note for s in (by_gaps, by_zones)] == ["solved by its gaps", ""]
    error, unit = by_gaps.error + by_zones.error, unit_of(by_zones)
    assert np.all(
        np.abs(by_gaps.zone_widths - by_zones.zone_widths) <= 2 * error * by_zones.zone_widths
    )
    assert np.all(
        np.abs(by_gaps.zone_loads - by_zones.zone_loads) <= 3 * error * unit * by_zones.zone_widths
    )
    assert abs(by_gaps.max_pressure - by_zones.max_pressure) <= error * unit
    for name in ("approach", "mean_gap"):
        assert (
            abs(getattr(by_gaps, name) - getattr(by_zones, name))
            <= 3 * error * unit * profile.period
        )
    assert by_gaps.stiffness == pytest.approx(by_zones.stiffness, rel=1e-6)


@pytest.mark.parametrize("tol", [1e-3, 1e-8])
@pytest.mark.parametrize("seed", range(6))
def test_errors_of_the_numbers_are_within_the_stated_bounds(seed, tol):
    rng = np.random.default_rng(seed)
    truth = random_problem(
        rng, zones=int(rng.integers(1, 5)), period=1.0, fraction=rng.uniform(0.2, 0.9)
    )
    assert_within_what_is_stated(
        contact.solve(contact.Scene(truth.profile, 1.0, PERIODIC, load=truth.load), tol=tol), truth
    )


@pytest.mark.parametrize("fraction", [0.1, 0.6, 0.99])
@pytest.mark.parametrize("closed", [exact.Westergaard, exact.PeriodicWedge])
def test_errors_against_closed_forms_are_within_the_stated_bounds(closed, fraction):
    profile = (
        contact.Sinusoid(1e-2, 1.0) if closed is exact.Westergaard else contact.Wedge(0.1, 1.0)
    )
    truth = closed(
        *((1e-2, 1.0) if closed is exact.Westergaard else (0.1, 1.0)), 1.0, 0.5 * fraction
    )
    for control in (
        {"load": truth.load},
        {"approach": truth.approach},
        {"contact_fraction": fraction},
    ):
        assert_within_what_is_stated(
            contact.solve(contact.Scene(profile, 1.0, PERIODIC, **control), tol=1e-6), truth
        )


def assert_within_what_is_stated(solution, truth):
    """Assert the error bounds of docs/errors.md, for E* = L = 1."""
    error, unit, widths = solution.error + 1e-14, unit_of(solution), solution.zone_widths
    assert np.all(np.abs(widths - truth.zone_widths) <= 2 * error * widths)
    assert np.all(
        np.abs(solution.zone_loads - getattr(truth, "zone_loads", truth.load))
        <= 3 * error * unit * widths
    )
    assert abs(solution.load - truth.load) <= 3 * error * unit * widths.sum()
    assert abs(solution.approach - truth.approach) <= 3 * error * unit
    assert (
        solution.max_pressure == truth.max_pressure
        or abs(solution.max_pressure - truth.max_pressure) <= error * unit
    )
    if hasattr(truth, "stiffness"):
        narrowest = min(hi - lo for lo, hi in numbers.open_intervals(solution))
        assert abs(1 / solution.stiffness - 1 / truth.stiffness) <= 4 * error * max(
            1.0, widths.max() / narrowest
        )
    # These errors are shown by print(solution).
    printed = Errors(solution)
    for name, bound in (
        ("load", printed.load),
        ("approach", printed.length),
        ("max_pressure", printed.pressure),
        ("stiffness", printed.stiffness),
    ):
        if np.isfinite(getattr(truth, name, np.inf)):
            value = getattr(truth, name)
            assert abs(getattr(solution, name) - value) <= bound + 1e-12 * abs(value)


def test_the_highest_of_several_peaks_of_nearly_equal_height_is_found():
    # Among the solver's first samples of the pressure, the highest one is not on the highest peak.
    rng = np.random.default_rng(14)
    waves = contact.Fourier(1.0, *(1e-3 * rng.normal(size=(2, 20)) * np.arange(1, 21) ** -1.5))
    solution = solved(waves, 0.05)
    t = np.linspace(-1, 1, 6001)
    samples = max(solution.pressure_at(t, k).max() for k in range(len(solution.zones)))
    assert samples <= (1 + solution.error) * solution.max_pressure <= (1 + 1e-6) * samples


def test_full_contact_has_no_zone_and_the_load_that_was_given():
    solution = solved(WAVES, 1.5)
    x = (np.arange(256) + 0.5) / 256
    assert (
        len(solution.zone_loads) == 0 and solution.mean_gap == 0.0 and np.isinf(solution.stiffness)
    )
    assert solution.pressure(x).mean() == pytest.approx(solution.load, rel=1e-13)
    heights = WAVES.height(np.linspace(0, 1, 20001))
    assert solution.approach == pytest.approx(-heights.min(), rel=1e-6)
    assert solution.displacement(x).mean() == pytest.approx(0.0, abs=1e-13 * np.ptp(heights))


def test_a_relative_error_of_a_billionth_in_the_load_of_one_zone_is_noticed():
    solution = solved(ROUGH, 0.6)
    loads = solution.zone_loads.copy()
    loads[0] *= 1 + 1e-9
    allowed = 3 * (solution.error + 1e-13) * solution.max_pressure * solution.zone_widths
    assert not np.all(np.abs(loads - numbers.zone_loads(solution)) <= allowed)
