"""Side conditions: equations without any, a user's own conditions in each method of solution, and
the effect of round-off in conditions.
"""

from collections.abc import Callable
from dataclasses import dataclass

import mpmath
import numpy as np
import pytest

import sie
from sie.basis import chebyshev
from sie.equation.conditions import Condition, by_zone
from sie.slits.system import SlitState
from sie.states.sizes import first_sizes
from sie.states.solve import SolveOptions
from sie.trees.krylov import gmres

T = np.linspace(-0.97, 0.97, 15)
WAVE = sie.Forcing(np.sin, lambda x: -np.cos(x))
CONSTANT = sie.Forcing(np.ones_like, lambda x: x, resolution=sie.Resolution(modes=1))
ROW = np.array([[2.0 * i, 2.0 * i + 1.2 + 0.05 * (i % 3)] for i in range(12)])


@dataclass(frozen=True)
class SameLevel(Condition):
    """Condition: the zones i and j have the same level."""

    i: int
    j: int
    levels = True

    def count(self, zones):
        return 1

    def rows(self, system):
        matrix, constants = system.levels()
        i, j = slice(self.i, self.i + 1), slice(self.j, self.j + 1)
        return matrix[i] - matrix[j], constants[i] - constants[j], np.zeros(1)


@dataclass(frozen=True)
class Unsaid(SameLevel):
    """The same condition without the declaration `levels`, which says that it needs potentials."""

    levels = False


@dataclass(frozen=True)
class SameIntensities(Condition):
    """Condition: the intensity at the leftmost end equals that at the rightmost end."""

    def count(self, zones):
        return 1

    def rows(self, system):
        (left, left_constant), (right, right_constant) = system.intensities()
        return left[:1] - right[-1:], left_constant[:1] - right_constant[-1:], np.zeros(1)


@dataclass(frozen=True)
class FirstTotal(Condition):
    """Condition: the total of the first zone is `value`."""

    value: float

    def count(self, zones):
        return 1

    def rows(self, system):
        matrix, constants = system.totals()
        return matrix[:1], constants[:1], np.array([self.value])


def difference(one, other):
    size = np.abs(one.density.coefficients).max()
    return (
        max(
            np.abs(one.density.at_t(i, T) - other.density.at_t(i, T)).max()
            for i in range(len(one.density.zones))
        )
        / size
    )


def by_matrix_and_by_sums(monkeypatch, equation, zones):
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=10**9))
    direct = sie.solve_zones(equation, zones)
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=1))
    iterated = sie.solve_zones(equation, zones)
    assert iterated.iterated and not direct.iterated
    assert np.all(iterated.intensity_noise < 1e-12)
    return direct, iterated


# Without side conditions: rows of aerofoils with bounded trailing edges
# -----------------------------------------------------------
@pytest.mark.parametrize("gap", [0.5, 1e-3])
def test_zones_without_side_conditions_state_their_error(gap):
    table = np.array([[0.0, 1.0], [1.0 + gap, 2.1], [2.1 + gap, 3.0]])
    state = sie.solve_zones(
        sie.Equation(sie.cauchy(), WAVE, ()), sie.Zones.of(table, sie.SINGULAR, sie.BOUNDED)
    )
    x = np.concatenate([0.5 * (a + b) + 0.5 * (b - a) * T for a, b in table])
    assert state.density.transform(x) == pytest.approx(np.sin(x), abs=1e-11)
    assert np.abs(state.density.intensities[1]).max() < 1e-14
    assert state.intensity_noise.shape == (2, 3) and np.all(state.intensity_noise < 1e-12)
    assert state.density_error < 1e-11


@pytest.mark.parametrize("sides", ["right", "mixed", "symmetric"])
@pytest.mark.parametrize("kernel", [sie.cauchy(), sie.hilbert(30.0)], ids=["line", "period"])
def test_given_bounded_ends_are_solved_by_fast_sums_too(monkeypatch, sides, kernel):
    table, mixed = ROW, np.arange(12) % 3 == 0
    if sides == "symmetric":
        table = ROW - 0.5 * (ROW[0, 0] + ROW[-1, 1])
        table = 0.5 * (table - table[::-1, ::-1])
        mixed = np.concatenate((~mixed[:6], mixed[:6][::-1]))
    left = [sie.BOUNDED if one and sides != "right" else sie.SINGULAR for one in mixed]
    right = [sie.SINGULAR if one and sides != "right" else sie.BOUNDED for one in mixed]
    zones = sie.Zones.of(table, left, right, symmetric=sides == "symmetric")
    direct, iterated = by_matrix_and_by_sums(monkeypatch, sie.Equation(kernel, WAVE, ()), zones)
    assert difference(direct, iterated) < min(1e-12, direct.density_error + iterated.density_error)


def test_a_system_too_large_for_a_matrix_and_without_fast_sums_is_refused_by_name(monkeypatch):
    options = SolveOptions(min_fast_unknowns=10, max_matrix_unknowns=100)
    monkeypatch.setattr("sie.states.solve.OPTIONS", options)
    both = [sie.Total(1.0)] + [sie.Weighted(lambda x, k=k: x**k, 0.0) for k in range(1, 12)]
    with pytest.raises(
        sie.SingularSystem,
        match="fast sums need exactly one of these: a condition with a row for each zone",
    ):
        sie.solve_zones(
            sie.Equation(sie.cauchy(), WAVE, tuple(both)),
            sie.Zones.of(ROW, sie.SINGULAR, sie.SINGULAR),
        )


# A user's own condition
# -----------------------------------------------------------------------------------------------------------------
OWN = {
    "some levels": ((sie.ZoneTotals(0.1), SameLevel(0, 3)), (CONSTANT,)),
    "levels unsaid": ((sie.ZoneTotals(0.1), Unsaid(1, 11)), (CONSTANT,)),
    "intensities": ((sie.Total(0.3), sie.EqualPotential(), SameIntensities()), (CONSTANT,)),
    "one total": ((sie.EqualPotential(), FirstTotal(0.2)), ()),
}


@pytest.mark.parametrize("name", OWN)
def test_a_user_s_condition_holds_by_matrix_and_by_fast_sums(monkeypatch, name):
    conditions, columns = OWN[name]
    zones = sie.Zones.of(ROW, sie.SINGULAR, sie.SINGULAR)
    direct, iterated = by_matrix_and_by_sums(
        monkeypatch, sie.Equation(sie.cauchy(), WAVE, conditions, columns), zones
    )
    assert difference(direct, iterated) < direct.density_error + iterated.density_error < 1e-11
    density = direct.density
    if "levels" in name:
        i, j = conditions[1].i, conditions[1].j
        levels = (
            density.potential(zones.middle)
            - WAVE.primitive(zones.middle)
            - density.amplitudes[0] * zones.middle
        )
        assert levels[i] == pytest.approx(levels[j], abs=1e-13)
        assert np.ptp(levels) > 1e-3
    elif name == "intensities":
        assert density.intensities[0][0] == pytest.approx(density.intensities[1][-1], abs=1e-13)
    else:
        assert density.totals[0] == pytest.approx(0.2, abs=1e-14)


@pytest.mark.parametrize("condition", [SameIntensities(), FirstTotal(0.2)])
@pytest.mark.parametrize("gap", [0.1, 0.02, 1e-3])
def test_a_user_s_condition_holds_for_any_width_of_a_gap(condition, gap):
    """If a narrow gap were treated as a slit in one wide zone, there would be no first zone. So
    with a user's condition no gap is treated as a slit.
    """
    zones = sie.Zones.of(
        [[-1.0, 0.0], [gap, 1.3]], [sie.SINGULAR, sie.FREE], [sie.FREE, sie.SINGULAR]
    )
    conditions, columns = (sie.Total(1.0), sie.EqualPotential(), condition), (CONSTANT,)
    state = sie.solve_zones(sie.Equation(sie.cauchy(), WAVE, conditions, columns), zones)
    assert not isinstance(state, SlitState)
    slack = 1e-12 + state.density_error
    if isinstance(condition, FirstTotal):
        assert state.density.totals[0] == pytest.approx(0.2, abs=slack)
    else:
        assert state.density.intensities[0][0] == pytest.approx(
            state.density.intensities[1][1], abs=slack
        )
    without = sie.solve_zones(sie.Equation(sie.cauchy(), WAVE, conditions[:2]), zones)
    assert isinstance(without, SlitState) == (gap < 0.1)


# A condition for every zone
# ------------------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class EveryZone(Condition):
    """Condition whose rows are computed by the function `told`, called with the system.

    The number of rows is the number of solved zones minus `fewer`.
    """

    told: Callable[[sie.Rows], tuple[np.ndarray, np.ndarray]]
    value: float = 0.1
    fewer: int = 0

    def count(self, zones):
        return len(zones.solved) - self.fewer

    def rows(self, system):
        matrix, constants = self.told(system)
        return matrix, constants, np.full(len(constants), self.value)


def sprung(system):
    """Rows for zones on springs: the level of each zone plus a factor times the zone's total."""
    both = zip(system.levels(), system.totals(), strict=True)
    stiff = 1 + 0.2 * np.arange(len(system.totals()[1]))
    return tuple(level + (stiff * total.T).T for level, total in both)


BY_ZONE = {
    "totals": (EveryZone(lambda system: system.totals()),),
    "first moments about a place": (
        EveryZone(lambda system: system.integrals(lambda x: 1 + 0.1 * x)),
    ),
    "edges": (EveryZone(lambda system: system.intensities()[1]),),
    "springs": (EveryZone(sprung),),
    "levels": (
        sie.Total(0.3),
        EveryZone(lambda system: tuple(-2.0 * part for part in system.level_steps()), 0.0, 1),
    ),
}


@pytest.mark.parametrize("symmetric", [False, True])
@pytest.mark.parametrize("name", BY_ZONE)
def test_a_user_s_condition_for_every_zone_holds_by_matrix_and_by_fast_sums(
    monkeypatch, name, symmetric
):
    table = ROW - 0.5 * (ROW[0, 0] + ROW[-1, 1])
    table = 0.5 * (table - table[::-1, ::-1]) if symmetric else ROW
    wave = sie.Forcing(np.sin, lambda x: -np.cos(x))
    weighted = name.startswith("first") and symmetric
    conditions = (
        (EveryZone(lambda system: system.integrals(lambda x: 1 + 0.1 * x * x)),)
        if weighted
        else BY_ZONE[name]
    )
    zones = sie.Zones.of(table, sie.SINGULAR, sie.SINGULAR, symmetric=symmetric)
    direct, iterated = by_matrix_and_by_sums(
        monkeypatch, sie.Equation(sie.cauchy(), wave, conditions), zones
    )
    assert difference(direct, iterated) < direct.density_error + iterated.density_error < 1e-11
    assert iterated.sizes.iterations < 40


def test_coefficients_of_a_condition_for_every_zone_are_found_by_trial_values():
    zones = sie.Zones.of(ROW, sie.SINGULAR, sie.SINGULAR)
    half = zones.half
    totals, springs, steps = (
        by_zone(BY_ZONE[name][-1], zones) for name in ("totals", "springs", "levels")
    )
    assert totals.first == pytest.approx(np.pi * half) and not totals.of_levels
    assert springs.levels == pytest.approx(np.ones(12)) and springs.first == pytest.approx(
        np.pi * half * (1 + 0.2 * np.arange(12))
    )
    assert steps.differences and steps.levels == pytest.approx(np.full(11, -2.0))
    assert by_zone(sie.ZoneTotals(), zones).first == pytest.approx(totals.first)

    def mixed(system):
        matrix, constants = system.totals()
        return matrix + matrix[::-1], constants + constants[::-1]

    def some(system):
        (matrix, constants), (levels, at) = system.totals(), system.levels()
        return np.concatenate((matrix[:6], levels[6:])), np.concatenate((constants[:6], at[6:]))

    assert by_zone(EveryZone(mixed), zones) is None and by_zone(EveryZone(some), zones) is None
    assert by_zone(sie.Total(1.0), zones) is None and by_zone(SameLevel(0, 3), zones) is None


@pytest.mark.parametrize("count", [40, 160])
def test_many_zones_under_a_user_s_condition_take_no_more_iterations(count):
    """A user's condition takes as many iterations as `ZoneTotals`, for any number of zones."""
    first = np.arange(count) + 0.1 * np.random.default_rng(2).random(count)
    zones = sie.Zones.of(np.column_stack((first, first + 0.7)), sie.SINGULAR, sie.SINGULAR)
    made = []
    for condition in (sie.ZoneTotals(0.1), BY_ZONE["totals"][0]):
        sizes = first_sizes(sie.Equation(sie.cauchy(), WAVE, (condition,)), zones)
        sizes.least = 48
        state = sie.solve_zones(sie.Equation(sie.cauchy(), WAVE, (condition,)), zones, 1e-12, sizes)
        assert state.iterated
        made.append(sizes.iterations)
    assert made[0] == made[1] < 30


@dataclass(frozen=True)
class Wrong(Condition):
    """Condition whose `rows` do not fit its `count`, or have a wrong form."""

    given: object

    def count(self, zones):
        return 1

    def rows(self, system):
        matrix, constants = system.totals()
        return self.given(matrix, constants)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            lambda m, c: (np.repeat(m, 2, axis=0), np.zeros(2), np.zeros(2)),
            r"its `count` is 1, so its `rows`",
        ),
        (lambda m, c: (m[:, :-1], c, c), r"arrays of the shapes \(1, \d+\)"),
        (lambda m, c: (m[0], c, c), "arrays of the shapes"),
        (lambda m, c: (m, c), "a tuple of three"),
        (lambda m, c: (1j * m, c, c), "matrix that its `rows` returns must be real"),
    ],
)
def test_rows_of_a_wrong_shape_are_refused_by_name(given, message):
    with pytest.raises(ValueError, match=message):
        sie.solve_fixed(
            sie.Equation(sie.cauchy(), WAVE, (Wrong(given),)),
            sie.Zones.of([[-1, 1]], sie.SINGULAR, sie.SINGULAR),
        )


def test_zone_totals_of_a_wrong_length_and_columns_that_are_not_there_are_refused_by_name():
    zones = sie.Zones.of([[-2, -1], [1, 2]], sie.SINGULAR, sie.SINGULAR)
    with pytest.raises(ValueError, match="2 zones are solved, so give one value or 2 values"):
        sie.solve_fixed(sie.Equation(sie.cauchy(), WAVE, (sie.ZoneTotals((1.0, 2.0, 3.0)),)), zones)
    conditions = (sie.Total(1.0), sie.EqualPotential(), sie.Amplitude(1))
    with pytest.raises(ValueError, match=r"amplitude of column 1 .*, but the equation has 1"):
        sie.solve_fixed(sie.Equation(sie.cauchy(), WAVE, conditions, (CONSTANT,)), zones)
    with pytest.raises(
        ValueError, match="Amplitude: its column must be a whole number of at least 0, got -1"
    ):
        sie.Amplitude(-1)


# Round-off of the conditions
# ------------------------------------------------------------------------------------------
@pytest.mark.parametrize("gap", [1e-1, 1e-2, 3e-3])
def test_rounding_of_the_side_conditions_is_in_the_stated_error(gap):
    """Zones with bounded ends at a gap and singular outer ends share a level; a constant on the
    right side is unknown.

    The narrower the gap, the worse the conditioning. A constant of the primitive and the datum of
    the logarithm change the density by round-off only. This change is less than twice the stated
    error.
    """
    zones = sie.Zones.of(
        [[-1.0, 0.0], [gap, 1.3]], [sie.SINGULAR, sie.BOUNDED], [sie.BOUNDED, sie.SINGULAR]
    )
    states = []
    for offset, datum in ((0.0, 1.0), (0.7, 1.0), (-2.3, 3.0), (0.0, 0.3)):
        forcing = sie.Forcing(np.sin, lambda x, offset=offset: offset - np.cos(x))
        states.append(
            sie.solve_fixed(
                sie.Equation(sie.cauchy(datum), forcing, (sie.EqualPotential(),), (CONSTANT,)),
                zones,
            )
        )
    found = max(difference(states[0], other) for other in states[1:])
    stated = max(state.density_error for state in states)
    assert found < 2 * stated
    # The error is about round-off / gap^2. A stated error much above it would be useless.
    assert stated < 1e-13 / gap**2
    if gap <= 1e-2:
        assert found > 1e-12


def test_high_modes_keep_the_digits_of_their_angles():
    """Whole turns are removed from the angles k theta in integer arithmetic.

    With the rounded product k theta, the sines and cosines would have errors of 1e-14.
    """
    n = 90
    with mpmath.workdps(30):
        for k, j in ((89, 88), (90, 90), (57, 83)):
            sine = (
                2
                / mpmath.mpf(n + 1)
                * mpmath.sin(k * j * mpmath.pi / (n + 1))
                * mpmath.sin(j * mpmath.pi / (n + 1))
            )
            assert chebyshev._sine_matrix(n)[k - 1, j - 1] == pytest.approx(float(sine), abs=3e-17)
            cosine = mpmath.cos((2 * j + 1) * k * mpmath.pi / (2 * 200))
            assert chebyshev.t_matrix(200, 100)[j, k] == pytest.approx(float(cosine), abs=5e-16)


def test_an_iteration_that_does_not_converge_is_the_reason_reported(monkeypatch):
    monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=1))
    monkeypatch.setattr(
        "sie.fast.iteration.gmres", lambda apply, b, tolerance: gmres(apply, b, tolerance, 2)
    )
    charge = sie.Equation(sie.cauchy(), WAVE, (sie.Total(1.0), sie.EqualPotential()))
    with pytest.raises(sie.NotConverged, match="the iteration .* does not converge"):
        sie.solve(charge, sie.Zones.of(ROW, sie.SINGULAR, sie.SINGULAR))


def test_a_given_intensity_at_given_ends_is_satisfied_by_fast_sums_too(monkeypatch):
    zones = sie.Zones.of(ROW, sie.SINGULAR, sie.End(moves=False, intensity=0.2))
    direct, iterated = by_matrix_and_by_sums(
        monkeypatch, sie.Equation(sie.cauchy(), WAVE, ()), zones
    )
    assert iterated.density.intensities[1] == pytest.approx(np.full(12, 0.2), rel=1e-12)
    assert difference(direct, iterated) < direct.density_error + iterated.density_error < 1e-11


@pytest.mark.parametrize("name", ["one total", "levels", "springs"])
def test_a_user_s_condition_holds_beside_a_narrow_gap_by_matrix_and_by_fast_sums(monkeypatch, name):
    """One gap is 1e-3 wide. With the engine's own conditions it is treated as a slit."""
    table = ROW.copy()
    table[5:] -= table[5, 0] - table[4, 1] - 1e-3
    zones = sie.Zones.of(table)
    conditions = OWN[name][0] if name in OWN else BY_ZONE[name]
    direct, iterated = by_matrix_and_by_sums(
        monkeypatch, sie.Equation(sie.cauchy(), WAVE, conditions), zones
    )
    stated = direct.density_error + iterated.density_error
    assert difference(direct, iterated) < stated < 1e-8
    if name == "levels":
        monkeypatch.setattr("sie.states.solve.OPTIONS", SolveOptions(min_fast_unknowns=10**9))
        with_slits = sie.solve_zones(
            sie.Equation(sie.cauchy(), WAVE, (sie.Total(0.3), sie.EqualPotential())), zones
        )
        assert isinstance(with_slits, SlitState)
        assert difference(with_slits, direct) < (stated + with_slits.density_error) * 10
