"""One symmetric zone: the closed form has the solution of the general search.
Both agree within their stated errors. The closed form is not used where it is in doubt.
"""

import copy
import pickle
from dataclasses import dataclass

import numpy as np
import pytest

import contact
import contact.solver
from contact.closed.fields import ClosedFields
from contact.closed.solve import solve_all_closed, solve_closed
from contact.reference.exact import (
    IsolatedBiquadratic,
    PeriodicParabola,
    PeriodicWedge,
    Westergaard,
)

PERIODIC, ISOLATED = contact.Periodic(), contact.Isolated(datum=3.0)


@dataclass(frozen=True)
class Even(contact.Profile):
    """A user's own symmetric profile with one tip."""

    b: float
    symmetric = property(lambda self: True)
    summits = property(lambda self: np.zeros(1))

    def height(self, x):
        return np.asarray(x) ** 2 / 2 + self.b * np.asarray(x) ** 4

    def slope(self, x):
        return np.asarray(x) + 4 * self.b * np.asarray(x) ** 3


@dataclass(frozen=True)
class Waves(contact.Profile):
    """A wave with its second harmonic: one tip for a <= 1/4, two tips for larger a."""

    a: float
    period: float = 1.0
    symmetric = property(lambda self: True)
    resolution = property(lambda self: 0.5 * self.period)

    @property
    def summits(self):
        tip = np.arccos(1 / max(4 * self.a, 1)) / (2 * np.pi) * self.period
        return np.array([-tip, tip]) if tip else np.zeros(1)

    def height(self, x):
        u = 2 * np.pi * np.asarray(x) / self.period
        return 1e-3 * (self.a * np.cos(2 * u) - np.cos(u))

    def slope(self, x):
        u = 2 * np.pi * np.asarray(x) / self.period
        return 2e-3 * np.pi / self.period * (np.sin(u) - 2 * self.a * np.sin(2 * u))


# Functions that make a profile from a length, a slope and a number `room`, and whether the
# scene is periodic.
SHAPES = {
    "wave": (lambda L, slope, room: contact.Sinusoid(slope * L, L), True),
    "lone wave": (lambda L, slope, room: contact.Sinusoid(slope * L, L), False),
    "parabolas": (lambda L, slope, room: contact.Parabola(L / slope, L), True),
    "parabola": (lambda L, slope, room: contact.Parabola(L / slope), False),
    "one of the parabolas": (lambda L, slope, room: contact.Parabola(L / slope, L), False),
    "wedges": (lambda L, slope, room: contact.Wedge(slope, L), True),
    "wedge": (lambda L, slope, room: contact.Wedge(slope), False),
    "punches": (lambda L, slope, room: contact.Flat(L, room * L), True),
    "punch": (lambda L, slope, room: contact.Flat(L), False),
    "own body": (lambda L, slope, room: Even(room), False),
    "own waves": (lambda L, slope, room: Waves(room / 24, L), True),
    "one of them": (lambda L, slope, room: Waves(room / 24, L), False),
}


def drawn(name, rng):
    """A random scene of any size; the load is from a range of nine decades."""
    make, repeats = SHAPES[name]
    L, slope, E_star = 10 ** rng.uniform(-6, 1), 10 ** rng.uniform(-4, -1), 10 ** rng.uniform(0, 11)
    L = 1.0 if name == "own body" else L
    profile = make(L, slope, rng.uniform(1.05, 6.0))
    model = PERIODIC if repeats else contact.Isolated(datum=L * 10 ** rng.uniform(0, 2))
    size = 1e-3 if name in ("own waves", "one of them") else 1.0 if name == "own body" else slope
    return contact.Scene(
        profile, E_star, model, load=E_star * L * size * 10 ** rng.uniform(-9, 0.3)
    )


def generally(scene, monkeypatch, tol=1e-7):
    """The solution of the general search, without the closed form."""
    with monkeypatch.context() as patched:
        patched.setattr(contact.solver, "solve_closed", lambda scene, tol: None)
        return contact.solve(scene, tol)


def unit_of(solution):
    """The largest pressure, or the mean contact pressure if the largest is infinite."""
    peak = solution.max_pressure
    return peak if np.isfinite(peak) else solution.load / solution.zone_widths.sum()


@pytest.mark.filterwarnings("ignore::contact.ModelWarning")
@pytest.mark.parametrize("name", SHAPES)
def test_the_closed_form_has_the_solution_of_the_general_search_over_nine_decades_of_load(
    name, monkeypatch
):
    rng, direct = np.random.default_rng(list(map(ord, name))), 0
    for _ in range(4):
        scene = drawn(name, rng)
        try:
            one, other = contact.solve(scene, 1e-8), generally(scene, monkeypatch)
        except contact.OutOfRange:
            with pytest.raises(contact.OutOfRange):
                contact.solve(scene, 1e-8)
            continue
        direct += isinstance(one.fields, ClosedFields)
        assert one.certificate.holds and one.zones.shape == other.zones.shape
        if len(one.zones) == 0:
            continue
        error, unit = one.error + other.error, unit_of(other)
        width = other.zone_widths
        assert np.all(np.abs(one.zones - other.zones) <= error * width[:, None])
        t = np.cos(np.linspace(0.03, np.pi - 0.04, 21))
        # Next to a corner or a kink the pressure is not bounded. There the pressure multiplied by
        # sqrt(1 - t^2) is compared.
        weight = np.sqrt(1 - t**2) if not np.isfinite(other.max_pressure) else 1.0
        for zone in range(len(one.zones)):
            assert np.all(
                weight * np.abs(one.pressure_at(t, zone) - other.pressure_at(t, zone))
                <= error * unit
            )
        length = scene.period or width.max()
        slack = 3 * error * unit * length / scene.E_star
        assert np.abs(one.zone_loads - other.zone_loads).max() <= 3 * error * unit * width.max()
        assert abs(one.approach - other.approach) <= slack + other.certificate.gap_rounding
        assert abs(
            1 / one.stiffness - 1 / other.stiffness
        ) <= 4 * error / scene.E_star + 1e-14 / abs(other.stiffness)
        assert one.max_pressure <= one.fields.pressure_bound * (1 + 1e-12)
        assert (one.max_pressure == other.max_pressure) or abs(
            one.max_pressure - other.max_pressure
        ) <= error * unit
        x = other.zones[-1, 1] + width[-1] * np.array([0.01, 0.3, 2.0])
        here, there = one.gap(x), other.gap(x)
        known = np.isfinite(there)
        assert np.all(np.isinf(here[~known])) and np.all(
            np.abs(here[known] - there[known]) <= slack + 10 * other.certificate.gap_rounding
        )
    assert direct >= 2


@pytest.mark.parametrize("fraction", [1e-4, 0.1, 0.5, 0.85])
def test_the_true_error_is_at_most_the_stated_one(fraction):
    a = 0.5 * fraction
    for answer, profile in [
        (Westergaard(1e-3, 1.0, 1.0, a), contact.Sinusoid(1e-3, 1.0)),
        (PeriodicParabola(1.0, 1.0, 1.0, a), contact.Parabola(1.0, 1.0)),
        (PeriodicWedge(0.01, 1.0, 1.0, a), contact.Wedge(0.01, 1.0)),
    ]:
        found = contact.solve(contact.Scene(profile, 1.0, PERIODIC, load=answer.load), 1e-11)
        assert isinstance(found.fields, ClosedFields)
        assert abs(found.zones[0, 1] - a) <= 2 * a * found.error
        t = np.linspace(-0.99, 0.99, 40)
        assert np.all(
            np.abs(found.pressure_at(t) - answer.pressure(a * t)) <= found.error * unit_of(found)
        )


@pytest.mark.parametrize("over_merging", [1e-2, 0.5, 0.999, 1.5, 2.0, 1e3])
def test_two_zones_are_left_to_the_general_search_until_they_have_merged(over_merging):
    load = over_merging * IsolatedBiquadratic(1.0, 0.1, 1.0, 1.0).merging_load
    scene = contact.Scene(contact.Biquadratic(1.0, 0.1), 1.0, ISOLATED, load=load)
    found = solve_closed(scene, 1e-8)
    assert (found is not None) == (over_merging > 1.0)
    if found is not None:
        known = IsolatedBiquadratic(1.0, 0.1, 1.0, load)
        assert known.zones == pytest.approx(found.zones, rel=found.error)


def test_a_given_width_and_a_load_lead_to_each_other():
    for profile, model in [
        (contact.Sinusoid(1e-3, 1.0), PERIODIC),
        (contact.Wedge(0.01), ISOLATED),
        (Even(3.0), ISOLATED),
    ]:
        wide = contact.solve(contact.Scene(profile, 1.0, model, half_width=0.2), 1e-12)
        back = contact.solve(contact.Scene(profile, 1.0, model, load=wide.load), 1e-12)
        assert back.zones[0, 1] == pytest.approx(0.2, rel=1e-12) and wide.zones.tolist() == [
            [-0.2, 0.2]
        ]


@pytest.mark.filterwarnings("ignore::contact.ModelWarning")
@pytest.mark.parametrize("name", [name for name in SHAPES if "punch" not in name])
def test_a_given_approach_and_a_load_lead_to_each_other(name, monkeypatch):
    rng, direct = np.random.default_rng(list(map(ord, name + "approach"))), 0
    for _ in range(6):
        scene = drawn(name, rng)
        try:
            under_load = contact.solve(scene, 1e-6)
        except contact.OutOfRange:
            continue
        # An approach within the round-off of the heights does not determine the load.
        told = (
            under_load.approach
            > 1e-9 * np.abs(scene.profile.height(np.array(under_load.zones))).max()
        )
        if not isinstance(under_load.fields, ClosedFields) or not (
            under_load.stiffness > 0 and told
        ):
            continue
        back = contact.solve(scene.under("approach", under_load.approach), 1e-6)
        direct += isinstance(back.fields, ClosedFields)
        assert (
            back.certificate.holds
            and abs(back.approach / under_load.approach - 1) <= 1e-12 + back.error
        )
        assert (
            np.abs(back.zones - under_load.zones).max()
            <= (back.error + under_load.error) * under_load.zone_widths.max()
        )
    assert direct >= 2


def test_an_approach_of_nearly_full_contact_or_more_is_left_to_the_general_search():
    for approach in (0.999999e-3, 1.1e-3):
        assert (
            solve_closed(
                contact.Scene(contact.Sinusoid(1e-3, 1.0), 1.0, PERIODIC, approach=approach), 1e-9
            )
            is None
        )


class Stuck(contact.Law):
    """A frictionless law with a check of its own, which always fails."""

    name = "stuck"
    convex = turns = by_gaps = full_contact = True

    def fault(self, fields, load):
        return "it never holds"


@pytest.mark.parametrize(
    "scene",
    [
        contact.Scene(contact.Parabola(1.0), 1.0, ISOLATED, load=1e-3, tilt=1e-3),
        contact.Scene(
            contact.Parabola(1.0, 1.0), 1.0, PERIODIC, substrate=contact.Layer(0.2, 0.3), load=1e-3
        ),
        contact.Scene(
            contact.Parabola(1.0),
            1.0,
            contact.Isolated(),
            substrate=contact.Layer(0.2, 0.3),
            load=1e-3,
        ),
        contact.Scene(
            contact.Sinusoid(1e-3, 1.0), 1.0, contact.Localized("self-consistent"), load=1e-4
        ),
        contact.Scene(contact.Sinusoid(1e-3, 1.0), 1.0, PERIODIC, law=contact.JKR(1e-9), load=1e-4),
        contact.Scene(contact.Sinusoid(1e-3, 1.0), 1.0, PERIODIC, load=3.135e-3),
        contact.Scene(contact.Fourier(1.0, [-1e-3, 4e-4]), 1.0, PERIODIC, load=1e-4),
    ],
    ids=["turned", "layer", "lone layer", "localized", "adhesion", "nearly full", "tips unknown"],
)
def test_scenes_without_a_closed_form_are_left_to_the_general_search(scene):
    assert not isinstance(contact.solve(scene).fields, ClosedFields)


def test_a_law_with_a_check_of_its_own_is_asked():
    with pytest.raises(contact.NotConverged):
        contact.solve(contact.Scene(contact.Parabola(1.0), 1.0, ISOLATED, law=Stuck(), load=1e-3))


@dataclass(frozen=True)
class Shouldered(contact.Profile):
    """A profile with one tip, and with two shoulders that touch as well under a load.
    The shoulders have minima of the height, but are not among the declared `summits`.
    """

    symmetric = property(lambda self: True)
    summits = property(lambda self: np.zeros(1))

    def height(self, x):
        return np.asarray(x) ** 2 / 2 - 0.6 * self.bump(np.asarray(x))

    def slope(self, x):
        x = np.asarray(x)
        return x - 0.6 * (self.bump(x + 1e-6) - self.bump(x - 1e-6)) / 2e-6

    def bump(self, x):
        return np.exp(-(((np.abs(x) - 1.2) / 0.25) ** 2))


def test_a_profile_that_touches_beside_its_tip_is_not_taken_for_one_zone():
    found = contact.solve(contact.Scene(Shouldered(), 1.0, ISOLATED, load=0.3), 1e-3)
    assert len(found.zones) > 1 and not isinstance(found.fields, ClosedFields)


def test_all_members_work_and_survive_a_pickle_and_a_copy():
    for scene in (
        contact.Scene(contact.Sinusoid(1e-3, 1.0), 1.0, PERIODIC, load=1e-3),
        contact.Scene(contact.Wedge(0.1), 1.0, ISOLATED, load=1e-4),
        contact.Scene(contact.Flat(0.5, 1.0), 1.0, PERIODIC, load=1e-3),
    ):
        first = contact.solve(scene)
        for again in (pickle.loads(pickle.dumps(first)), copy.deepcopy(first)):
            assert type(again) is contact.Solution and again.to_dict() == first.to_dict()
            x = np.linspace(-1, 1, 33)
            for name in ("pressure", "gap", "displacement"):
                assert np.array_equal(getattr(again, name)(x), getattr(first, name)(x))
            assert str(again.plan) == str(first.plan) and "one zone" in str(first.plan)
            assert again.certificate.to_dict() == first.certificate.to_dict()


def test_a_curve_of_one_interval_is_solved_without_the_engine(monkeypatch):
    monkeypatch.setattr("contact.solver._run", lambda task: pytest.fail("the general machine ran"))
    wave = contact.Scene(contact.Sinusoid(1e-3, 1.0), 1.0, PERIODIC, mean_pressure=1e-3)
    pressures = np.linspace(0.01, 0.9, 50) * np.pi * 1e-3
    found = contact.solve_many(wave, pressures)
    assert all(s.certificate.holds and s.error < 1e-12 for s in found)
    assert np.allclose(
        [np.sin(np.pi * s.zones[0, 1]) ** 2 for s in found], pressures / (np.pi * 1e-3), rtol=1e-12
    )
    assert contact.path(wave, pressures).events == ()


@pytest.mark.filterwarnings("ignore::contact.ModelWarning")
@pytest.mark.parametrize("name", SHAPES)
def test_one_load_and_several_at_once_have_the_same_answer(name):
    rng = np.random.default_rng(list(map(ord, name)))
    for _ in range(4):
        scene = drawn(name, rng)
        loads = scene.load * np.array([1.0, 1.3, 0.01])
        alone = [solve_closed(scene.under("load", load), 1e-8) for load in loads]
        several = solve_all_closed([scene.under("load", load) for load in loads], 1e-8)
        for a, b in zip(alone, several, strict=True):
            assert (a is None) == (b is None)
            assert (
                a is None
                or np.abs(a.zones - b.zones).max() <= (a.error + b.error) * a.zone_widths.min()
            )


def bounded(k, half, a):
    """The density Phi at y = half cos(a), for the right-hand side G = T_k(y) on |y| < half.
    half is close to 1.
    """
    inside = np.polynomial.Chebyshev.basis(k)(np.polynomial.Chebyshev([0.0, half]))
    return np.sin(np.outer(a, np.arange(k + 1))) @ inside.coef


@pytest.mark.parametrize("k", range(1, 12, 2))
def test_the_pressure_changes_with_the_ends_no_faster_than_the_stated_error_assumes(k):
    """The stated error assumes that |d Phi/d half| <= k^2 for the right-hand side G = T_k.
    At half = 1 this derivative is k (1 - cos(a) cos(k a)) / sin(a).
    """
    a, d = np.linspace(1e-3, np.pi - 1e-3, 2001), 1e-6
    by_half = (1 - np.cos(a) * np.cos(k * a)) / np.sin(a)
    assert np.abs(by_half).max() <= k * (1 + 1e-12)
    some = slice(200, 1900, 100)
    grown = (bounded(k, 1 + d, a[some]) - bounded(k, 1 - d, a[some])) / (2 * d)
    assert grown == pytest.approx(k * by_half[some], rel=1e-6, abs=1e-6)


def test_one_zone_takes_a_few_evaluations_of_the_slope(monkeypatch):
    looks, plain = [], contact.Sinusoid.slope
    monkeypatch.setattr(
        contact.Sinusoid, "slope", lambda self, x: looks.append(np.size(x)) or plain(self, x)
    )
    wave = contact.Sinusoid(1e-3, 1.0)
    wave.slope_sizes  # noqa: B018
    looks.clear()
    solution = contact.solve(contact.Scene(wave, 1.0, PERIODIC, load=1e-3), 1e-12)
    # The slope is evaluated in two Newton steps, at samples of the gap outside the zone, and
    # for its size in the zone.
    assert looks == [8, 8, 32, 8]
    assert (
        solution.certificate.holds
        and solution.plan.counts["profile_evaluations"] <= 48
        and len(looks) == 4
    )


@dataclass(frozen=True)
class Plateau(contact.Profile):
    """A flat top between round shoulders; a zone inside the flat top carries no load."""

    period: float = 1.0
    kinks = property(lambda self: np.array([[0.5, -0.8]]))
    symmetric = property(lambda self: True)
    summits = property(lambda self: np.zeros(1))

    def height(self, x):
        return np.maximum(np.abs(self.wrap(x)) - 0.3, 0.0) ** 2

    def slope(self, x):
        return 2 * np.sign(self.wrap(x)) * np.maximum(np.abs(self.wrap(x)) - 0.3, 0.0)


@pytest.mark.parametrize("load", [5e-324, 1e-300, 1e-200, 1e30, 1e200, 1e300])
def test_loads_near_the_limits_of_floating_point_are_solved_or_left_to_the_general_search(load):
    for profile in (
        contact.Sinusoid(1e-3, 1.0),
        contact.Parabola(1e300),
        contact.Wedge(0.1, 1.0),
        contact.Biquadratic(1.0, 0.1, 0.3),
    ):
        for model in (PERIODIC, ISOLATED) if profile.period else (ISOLATED,):
            for E_star in (1e-300, 1.0, 1e300):
                scene = contact.Scene(profile, E_star, model, load=load)
                alone, several = solve_closed(scene, 1e-8), solve_all_closed([scene, scene], 1e-8)
                assert (alone is None) == (several[0] is None) == (several[1] is None)
                assert alone is None or (
                    alone.certificate.holds
                    and np.isfinite(alone.zones).all()
                    and alone.zone_widths.min() > 0
                )


def test_a_flat_top_is_left_to_the_general_search():
    scene = contact.Scene(Plateau(), 1.0, PERIODIC, load=1e-3)
    assert solve_closed(scene, 1e-2) is None
    # The series converges slowly at the edges of the flat top: the stated error is about 0.02.
    assert 0.3 < contact.solve(scene, 0.1).zones[0, 1] < 0.35


@pytest.mark.parametrize("name", ["wave", "wedge", "parabolas"])
def test_the_ends_of_zones_move_at_the_stated_rates(name):
    scene = drawn(name, np.random.default_rng(3)).under("load", 1.0)
    scene = scene.under("load", 0.1 * scene.E_star * 1e-4 * (scene.period or 1.0))
    low, here, high = (
        contact.solve(scene.under("load", scene.load * np.exp(d)), 1e-11)
        for d in (-1e-4, 0.0, 1e-4)
    )
    outward = (high.zones - low.zones) / 2e-4 * [-1, 1]
    assert here.fields.spreading * [1, 1] == pytest.approx(outward, rel=1e-6)


def test_two_zones_whose_interval_comes_to_fill_the_period_are_left_to_the_general_search():
    # No load reaches this approach.
    two_tips = contact.Biquadratic(8.469013871188167, 0.5623775496434059, 0.6963644001577347)
    with pytest.raises(contact.OutOfRange, match="the mean of the profile"):
        contact.solve(
            contact.Scene(
                two_tips, 1.8602866940716e7, contact.Periodic(), approach=0.001731331755008503
            )
        )


@pytest.mark.parametrize("datum", [1e-6, 1e-2, 1e4])
@pytest.mark.parametrize("part", [1e-12, 1e-6, 1e-3, 0.1, 0.9])
@pytest.mark.filterwarnings("ignore::contact.ModelWarning")
def test_an_approach_of_a_lone_parabola_has_the_closed_form_for_any_datum(datum, part):
    """The approach of a parabola is at most datum^2 / radius, at the half width 2 datum."""
    profile, alone = contact.Parabola(1.0), contact.Isolated(datum=datum)
    approach = part * datum**2
    found = contact.solve(contact.Scene(profile, 1e9, alone, approach=approach))
    assert isinstance(found.fields, ClosedFields)
    again = contact.solve(contact.Scene(profile, 1e9, alone, load=found.load))
    assert again.approach == pytest.approx(approach, rel=1e-12)
