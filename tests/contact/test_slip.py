"""Partial slip and rolling: closed forms, laws on every route, and steps of friction on a grid."""

from __future__ import annotations

import math
import pickle
from dataclasses import dataclass, replace

import numpy as np
import pytest

import contact
from contact.slip.memory import Memory
from contact.studies.reflected import Reflected
from contact.studies.scene_families import PiecewiseLinear
from tests.contact.friction_grid import FrictionGrid

pytestmark = pytest.mark.filterwarnings("ignore::contact.ModelWarning")
MU, E = 0.4, 2.0
ISOLATED, PERIODIC = contact.Isolated(), contact.Periodic()
CYLINDER = contact.Parabola(1.0)
WAVE = contact.Sinusoid(0.01, 1.0)
TWO = contact.Fourier(1.0, [0.3e-2, -1e-2], [0.2e-2, 0.0])
ROUGH = contact.Fourier(1.0, [4e-3, -1e-3, 7e-4, 3e-4], [0.0, 2e-4, -3e-4, 1e-4])
HALF = 0.2


def solved(profile=CYLINDER, interaction=ISOLATED, **control):
    return contact.solve(contact.Scene(profile, E, interaction, **control), tol=1e-11)


@pytest.fixture(scope="module")
def cylinder():
    return solved(half_width=HALF)


def hertz(x, half):
    return np.sqrt(np.maximum(half**2 - x**2, 0.0))


X = np.linspace(-1.1, 1.1, 41) * HALF


def test_near_a_tip_the_stated_error_of_the_stress_includes_rounded_positions():
    """The shear causes no strain where the surfaces stick, so s_xx = -p there."""
    solution = solved(contact.Wedge(0.01), load=1e-3)
    slip = contact.partial_slip(solution, MU, (1 - 1e-5) * MU * solution.load)
    x = slip.stick_zones[0, 1] * np.linspace(-0.98, 0.98, 50)
    stress = slip.stress(x, 0.0 * x)
    assert np.all(np.abs(stress.xx + solution.pressure(x)) <= stress.error)
    assert stress.error.max() < 1e-7 * solution.pressure(x).min()


def test_the_error_of_the_lost_energy_includes_the_round_off_of_heights():
    """A small contact far from x = 0 and its mirror image lose the same energy.

    The heights near this contact are large, so their round-off matters.
    """
    lost = []
    for side in (1.0, -1.0):
        bowl = contact.Polynomial([0.0, -side * 1e-3, 4e-4, 0.0, 1e-5])
        scene = contact.Scene(bowl, E, ISOLATED, load=1e-12)
        slip = contact.load_history(scene, MU, [(1e-12, 0.0), (1e-12, side * 1e-13)])[1]
        lost.append((slip.dissipated, slip.dissipated_error))
    assert abs(lost[0][0] - lost[1][0]) <= lost[0][1] + lost[1][1]


def test_on_a_facet_that_ends_at_its_corners_the_shear_causes_no_strain():
    """The shear causes no strain where the surfaces stick, so s_xx = -p there.

    The load is small. So the logarithmic terms of the corners at the ends of the zone are far
    larger than the pressure.
    """
    facet = PiecewiseLinear(np.array([-3.4, -2.0, -0.17, 1.8]), np.array([0, 0, 7e-3, 7e-3]), 6.8)
    solution = solved(facet, PERIODIC, load=1e-9)
    slip = contact.partial_slip(solution, MU, 0.02 * MU * solution.load)
    x = solution.zones[0, 0] + 1.4 * np.linspace(0.02, 0.98, 50)
    stress = slip.stress(x, 0.0 * x)
    assert np.all(np.abs(stress.xx + solution.pressure(x)) <= stress.error)
    assert stress.error.max() < 1e-9 * solution.pressure(x).min()
    mirrored = contact.solve(replace(solution.scene, profile=Reflected(facet)), tol=1e-11)
    other = contact.partial_slip(mirrored, MU, -0.02 * MU * solution.load)
    assert abs(slip.shift + other.shift) <= slip.shift_error + other.shift_error


@pytest.mark.parametrize("part", [-0.9, -1e-3, 0.3, 0.75])
def test_a_cylinder_sticks_in_its_middle(cylinder, part):
    slip = contact.partial_slip(cylinder, MU, part * MU * cylinder.load)
    inner = HALF * np.sqrt(1 - abs(part))
    wanted = np.sign(part) * MU * (hertz(X, HALF) - hertz(X, inner))
    assert np.abs(slip.shear(X) - wanted).max() < 1e-10 * MU * HALF
    assert np.allclose(slip.stick_zones, [[-inner, inner]], rtol=0, atol=1e-10 * HALF)
    assert np.allclose(slip.slip_zones, [[-HALF, -inner], [inner, HALF]], rtol=0, atol=1e-11)


def test_the_shift_is_friction_times_the_difference_of_two_approaches():
    one = solved(interaction=contact.Isolated(datum=3.0), half_width=HALF)
    other = solved(interaction=contact.Isolated(datum=3.0), half_width=0.6 * HALF)
    slip = contact.partial_slip(one, MU, MU * (other.load - one.load))
    assert slip.shift == pytest.approx(MU * (other.approach - one.approach), rel=1e-10)


def test_a_cycle_on_a_cylinder_has_the_closed_form(cylinder):
    most, P = 0.7, cylinder.load
    parts = [most, 0.2, -most, 0.3, most]
    history = [(P, 0.0), *((P, part * MU * P) for part in parts)]
    slips = contact.load_history(cylinder.scene, MU, history, tol=1e-11)[1:]

    def shear(steps):
        """A sum of Hertz pressures on the half widths HALF sqrt(1 - part), times their weights."""
        return sum(weight * hertz(X, HALF * np.sqrt(1 - part)) for weight, part in steps)

    wanted = [
        [(1, 0), (-1, most)],
        [(-1, 0), (2, 0.5 * (most - 0.2)), (-1, most)],
        [(-1, 0), (1, most)],
        [(1, 0), (-2, 0.5 * (most + 0.3)), (1, most)],
        [(1, 0), (-1, most)],
    ]
    for slip, steps in zip(slips, wanted, strict=True):
        assert np.abs(slip.shear(X) - MU * shear(steps)).max() < 1e-10 * MU * HALF
    inner = HALF * np.sqrt(1 - 0.5 * (most + 0.3))
    assert np.allclose(slips[3].stick_zones, [[-inner, inner]], rtol=0, atol=1e-10 * HALF)


@pytest.mark.parametrize(
    ("scene", "factor"),
    [
        (contact.Scene(CYLINDER, E, ISOLATED, half_width=HALF), 1.0),
        (contact.Scene(CYLINDER, E, contact.Isolated(datum=5.0), half_width=HALF), 1.0),
        (contact.Scene(WAVE, E, PERIODIC, contact_fraction=0.6), 1.0),
        (contact.Scene(contact.Wedge(0.1), E, ISOLATED, load=0.01), 2.0),
    ],
    ids=["cylinder", "datum", "wave", "wedge"],
)
@pytest.mark.parametrize("part", [0.4, 0.95])
def test_a_cycle_loses_the_energy_of_the_closed_form(scene, factor, part):
    P = contact.solve(scene, tol=1e-11).load
    Q = part * MU * P
    history = [(P, 0.0), (P, Q), (P, -Q), (P, Q)]
    there, back = contact.load_history(scene, MU, history, tol=1e-11)[2:]
    wanted = part - part**2 / 2 + (1 - part) * np.log1p(-part)
    wanted *= factor * 4 * MU**2 * P**2 / (np.pi * E)
    assert there.dissipated + back.dissipated == pytest.approx(wanted, rel=1e-10)
    assert there.dissipated == pytest.approx(back.dissipated, rel=1e-10)


@pytest.mark.parametrize("part", [-0.4, 1e-3, 0.7, 0.99])
@pytest.mark.parametrize("leading", ["right", "left"])
def test_a_wheel_has_the_creepage_of_carter(cylinder, part, leading):
    slip = contact.rolling(cylinder, MU, part * MU * cylinder.load, leading=leading)
    inner = HALF * np.sqrt(1 - abs(part))
    at = (HALF - inner) * (1 if leading == "right" else -1)
    wanted = np.sign(part) * MU * (hertz(X, HALF) - hertz(X - at, inner))
    assert np.abs(slip.shear(X) - wanted).max() < 1e-10 * MU * HALF
    assert slip.creepage == pytest.approx(np.sign(part) * MU * (HALF - inner), abs=1e-12)
    given = contact.rolling(cylinder, MU, creepage=slip.creepage, leading=leading)
    assert given.tangential_load == pytest.approx(slip.tangential_load, rel=1e-9)


def test_a_wheel_slides_from_some_creepage_on(cylinder):
    slip = contact.rolling(cylinder, MU, creepage=-1.01 * MU * HALF)
    assert slip.slides and slip.tangential_load == -MU * cylinder.load
    assert contact.rolling(cylinder, MU, MU * cylinder.load).creepage is None


ROUTES = {
    "closed": lambda: solved(half_width=HALF),
    "wave": lambda: solved(WAVE, PERIODIC, contact_fraction=0.5),
    "two zones": lambda: solved(TWO, PERIODIC, load=0.012),
    "gaps": lambda: solved(ROUGH, PERIODIC, contact_fraction=0.97),
    "full contact": lambda: solved(ROUGH, PERIODIC, mean_pressure=0.1),
    "punch": lambda: solved(contact.Flat(1.0), load=0.1),
    "tilted": lambda: solved(tilt=0.05, load=0.02),
    "kinks": lambda: solved(contact.Wedge(0.01, 1.0), PERIODIC, load=3e-3),
}


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize("part", [-0.5, 0.999])
def test_where_a_contact_sticks_the_shear_causes_no_strain(route, part):
    solution = ROUTES[route]()
    slip = contact.partial_slip(solution, MU, part * MU * solution.load)
    size = MU * solution.load / max(np.sum(slip.slip_zones[:, 1] - slip.slip_zones[:, 0]), 0.3)
    nodes = 0.5 - 0.5 * np.cos(np.linspace(0.05, np.pi - 0.05, 8))
    for (lo, hi), sticks in [(one, True) for one in slip.stick_zones] + [
        (one, False) for one in slip.slip_zones
    ]:
        x = lo + (hi - lo) * nodes
        stress = slip.stress(x, 0.0 * x)
        limit = MU * solution.pressure(x)
        assert np.all(np.abs(slip.shear(x)) <= limit + 1e-8 * size)
        assert np.abs(stress.xy + slip.shear(x)).max() < 1e-8 * size
        if sticks:  # s_xx = -p - 2 T q, and T q is the strain
            assert np.abs(stress.xx + solution.pressure(x)).max() < 1e-7 * size
        else:
            assert np.abs(np.abs(slip.shear(x)) - limit).max() < 1e-8 * size


@pytest.mark.parametrize("part", [0.2, 0.8])
def test_a_wheel_of_the_fourth_power_has_the_closed_form(part):
    """The slope is f' = (2/E*) (g1 x + g3 x^3); the stick zone begins at the leading edge."""
    g1, g3 = 0.3, 2.0
    solution = solved(contact.Polynomial([0, 0, g1 / E, 0, 0.5 * g3 / E]), load=0.2)
    half, rest = solution.zones[0, 1], (1 - part) * solution.load
    slip = contact.rolling(solution, MU, part * MU * solution.load, tol=1e-11)
    left, right = slip.stick_zones[0]
    e, w = 0.5 * (right + left), 0.5 * (right - left)
    n1, n0 = 3 * g3 * e, 3 * g3 * e**2 + g1 + g3 * w**2 / 2
    assert abs(right - half) < 1e-12
    assert np.pi * (n0 * w**2 / 2 + g3 * w**4 / 8) == pytest.approx(rest, rel=1e-10)
    assert slip.creepage == pytest.approx(
        2 * MU / E * (n1 * w**2 / 2 + g3 * e**3 + g1 * e), rel=1e-10
    )
    y = w * np.linspace(-0.99, 0.99, 9)
    wanted = MU * (solution.pressure(e + y) - np.sqrt(w**2 - y**2) * (n0 + n1 * y + g3 * y**2))
    assert np.abs(slip.shear(e + y) - wanted).max() < 1e-10 * MU * solution.max_pressure


@pytest.mark.parametrize("leading", ["right", "left"])
@pytest.mark.parametrize("part", [-0.3, 0.9, 0.999])
def test_all_zones_that_roll_have_one_strain_where_they_stick(leading, part):
    solution = solved(contact.Polynomial([0, 0.01, -1.0, 0, 1.0]), load=0.05)
    assert len(solution.zones) == 2
    slip = contact.rolling(solution, MU, part * MU * solution.load, leading=leading)
    own = solution.zones[:, 1] if leading == "right" else solution.zones[:, 0]
    at = slip.stick_zones[:, 1] if leading == "right" else slip.stick_zones[:, 0]
    assert np.all(np.abs(own[:, None] - at).min(axis=0) < 1e-12)
    x = np.concatenate([np.linspace(lo, hi, 9)[1:-1] for lo, hi in slip.stick_zones])
    strain = slip.stress(x, 0.0 * x).xx + solution.pressure(x)
    sign = -1.0 if leading == "right" else 1.0
    assert np.abs(strain - sign * E * slip.creepage).max() < 1e-9 * MU * solution.max_pressure
    x = np.concatenate([np.linspace(lo, hi, 9)[1:-1] for lo, hi in slip.slip_zones])
    strain = slip.stress(x, 0.0 * x).xx + solution.pressure(x)
    assert np.all(np.sign(part) * (sign * strain - E * slip.creepage) < 0)
    given = contact.rolling(solution, MU, creepage=slip.creepage, leading=leading)
    assert given.tangential_load == pytest.approx(slip.tangential_load, rel=1e-8)
    assert len(given.stick_zones) == len(slip.stick_zones) == (1 if part == 0.999 else 2)


@dataclass(frozen=True)
class Cusped(contact.Profile):
    """Two parabolas that meet at a concave kink, over which there is a gap under any load."""

    left: float
    right: float

    @property
    def kinks(self):
        return np.array([[0.0, -(self.left + self.right)]])

    def height(self, x):
        return x * np.where(x < 0, 0.5 * x + self.left, 0.5 * x - self.right)

    def slope(self, x):
        return np.where(x < 0, x + self.left, x - self.right)


@pytest.mark.parametrize(("load", "part"), [(0.1, 0.4), (1.3, 0.4), (2.0, 0.61), (2.0, -0.9)])
@pytest.mark.parametrize("leading", ["right", "left"])
def test_beside_a_very_narrow_gap_a_wheel_has_one_load_for_one_creepage(load, part, leading):
    scene = contact.Scene(Cusped(0.1, 0.05), E, ISOLATED, load=load)
    solution = contact.solve(scene)
    assert len(solution.zones) == 2
    slip = contact.rolling(solution, MU, part * MU * load, leading=leading)
    given = contact.rolling(solution, MU, creepage=slip.creepage, leading=leading)
    size = MU * load * (slip.error + given.error)
    assert abs(given.tangential_load - slip.tangential_load) <= size
    assert given.stick_zones == pytest.approx(slip.stick_zones, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40))
def test_random_wheels_roll_with_one_strain_or_are_refused(seed):
    rng = np.random.default_rng(seed)
    shape = np.poly1d([0.1])
    for at in rng.uniform(-1, 1, rng.integers(2, 6)):
        shape = shape * np.poly1d([1, -2 * at, at * at + rng.uniform(0, 0.02)])
    profile = contact.Polynomial(shape.coeffs[::-1].tolist())
    scene = contact.Scene(profile, E, ISOLATED, load=10 ** rng.uniform(-5, -1.5))
    solution = contact.solve(scene, tol=1e-9)
    part, leading = 1 - 10 ** rng.uniform(-4, -0.1), rng.choice(["right", "left"])
    try:
        slip = contact.rolling(solution, MU, part * MU * solution.load, leading=leading)
    except contact.SceneError as error:
        assert "several places" in str(error)
        return
    x = np.concatenate([np.linspace(lo, hi, 9)[1:-1] for lo, hi in slip.stick_zones])
    strain = slip.stress(x, 0.0 * x).xx + solution.pressure(x)
    sign = -1.0 if leading == "right" else 1.0
    assert np.abs(strain - sign * E * slip.creepage).max() < 1e-7 * MU * solution.max_pressure
    given = contact.rolling(solution, MU, creepage=slip.creepage, leading=leading)
    assert given.tangential_load == pytest.approx(slip.tangential_load, rel=1e-6)


def test_a_bulk_stress_moves_the_zone_that_sticks():
    # The closed form is that of D. Nowell and D. A. Hills, Int. J. Mech. Sci. 29, 1987,
    # 355-365.
    solution = solved(half_width=HALF)
    peak, part = 0.5 * E * HALF, 0.6
    inner = HALF * np.sqrt(1 - part)
    most = 4 * MU * peak * (1 - inner / HALF)
    for sign in (1, -1):
        slip = contact.partial_slip(solution, MU, sign * part * MU * solution.load, 0.5 * most)
        middle = sign * 0.5 * (HALF - inner)
        assert np.allclose(slip.stick_zones, [[middle - inner, middle + inner]], rtol=0, atol=1e-12)
        wanted = sign * MU * (hertz(X, HALF) - hertz(X - middle, inner))
        assert np.abs(slip.shear(X) - wanted).max() < 1e-10 * MU * HALF
        x = np.linspace(*slip.stick_zones[0], 7)[1:-1]
        assert np.allclose(slip.stress(x, 0 * x).xx + solution.pressure(x), 0.25 * most)
    contact.partial_slip(solution, MU, part * MU * solution.load, 0.999 * most)
    with pytest.raises(contact.SceneError, match="opposite directions"):
        contact.partial_slip(solution, MU, part * MU * solution.load, 1.001 * most)


@pytest.mark.parametrize("load", [2e-3, 6e-3])
def test_a_rough_period_slips_as_in_steps_on_a_grid(load):
    solution = contact.solve(contact.Scene(TWO, 1.0, PERIODIC, load=load), tol=1e-10)
    slip = contact.partial_slip(solution, MU, 0.6 * MU * load)
    far = []
    for n in (128, 512):
        grid = FrictionGrid(n, TWO.height, MU)
        grid.step(load, 0.0)
        grid.step(load, 0.6 * MU * load)
        far.append(np.abs(slip.shear(grid.x) - grid.q).mean() / MU / solution.max_pressure)
    assert far[1] < 2e-4 + 0.5 * far[0]
    assert abs(grid.shift / slip.shift - 1) < 3e-4
    assert grid.lost == pytest.approx(slip.dissipated, rel=5e-3)


def random_history(seed):
    rng = np.random.default_rng(seed)
    loads = rng.uniform(1e-3, 8e-3, 5)
    points = [(P, MU * P * rng.uniform(-0.95, 0.95)) for P in loads]
    points.insert(3, (points[2][0], -0.5 * points[2][1]))
    return points


@pytest.mark.parametrize(
    ("seed", "n"),
    [(1, 96), *(pytest.param(seed, 192, marks=pytest.mark.slow) for seed in range(2, 14))],
)
def test_random_histories_agree_with_steps_on_a_grid(seed, n):
    points = random_history(seed)
    scene = contact.Scene(TWO, 1.0, PERIODIC, load=1.0)
    slips = contact.load_history(scene, MU, points, tol=1e-9)
    far, lost = [], []
    for steps in (n // 12, n // 3):
        grid, memory, before = FrictionGrid(n, TWO.height, MU), Memory(MU), (0.0, 0.0)
        far.append([])
        lost.append([])
        for point in points:
            begun = grid.lost
            for k in range(1, steps + 1):
                part = k / steps
                grid.step(*(a + (b - a) * part for a, b in zip(before, point, strict=True)))
            before = point
            layers = memory.go_to(*point).layers
            h = [*(layer.h for layer in layers), 0.0]
            wanted = sum(
                (h[k] - h[k + 1]) * grid.pressure(layer.top) for k, layer in enumerate(layers)
            )
            far[-1].append(np.abs(grid.q - wanted).mean() / np.abs(grid.q).mean())
            lost[-1].append(grid.lost - begun)
    # The error of the grid is proportional to the length of its steps. Extrapolation to steps
    # of length zero removes most of this error from the lost energy.
    assert max(far[1]) < 0.5 * max(far[0]) and max(far[1]) < 0.2
    lost = np.add(lost[1], np.subtract(lost[1], lost[0]) / 3)
    by_memory = np.array([slip.dissipated for slip in slips])
    size = (MU * 8e-3) ** 2 / np.pi
    assert np.abs(lost - by_memory).max() < 0.01 * by_memory.sum() + 3e-4 * size


BOWL = contact.Polynomial([0.0, -1e-3, 4e-4, 0.0, 1e-5])
LOSSES = {
    "cylinder": (contact.Scene(CYLINDER, E, ISOLATED, load=0.3), 1e-3),
    "bowl": (contact.Scene(BOWL, E, ISOLATED, load=1e-6), math.inf),
    "datum": (contact.Scene(BOWL, E, contact.Isolated(datum=1.0), load=1e-6), 1e-2),
    "wave": (contact.Scene(WAVE, E, PERIODIC, load=2e-3), 1e-3),
    "rough": (contact.Scene(ROUGH, E, PERIODIC, load=2e-3), 1e-2),
}


@pytest.mark.parametrize("name", LOSSES)
@pytest.mark.parametrize("grows", [True, False])
@pytest.mark.parametrize("part", [0.1, 1e-3, 1e-5, 1e-7])
def test_a_segment_loses_what_its_halves_lose(name, grows, part):
    """A segment of the history loses as much energy as its two halves.

    This also holds if the load changes far more, or far less, than the stick load: the load whose
    zones of contact stick.
    """
    scene, largest = LOSSES[name]
    start, q = scene.load, 0.5 * MU * scene.load
    end = (1.5 * start, q * (1 + part)) if grows else (start * (1 - part), q)
    middle = (0.5 * (start + end[0]), 0.5 * end[1])
    (_, whole), (_, *halves) = (
        contact.load_history(scene, MU, [(start, 0.0), *points])
        for points in ([end], [middle, end])
    )
    difference = whole.dissipated - sum(half.dissipated for half in halves)
    stated = whole.dissipated_error + sum(half.dissipated_error for half in halves)
    assert abs(difference) <= stated
    assert part < 1e-3 or whole.dissipated_error <= largest * whole.dissipated


def test_tips_do_not_make_the_lost_energy_infinite():
    """Some nodes of the quadrature round to a tip, where the pressure is infinite."""
    at = np.array([-0.9, -0.68, -0.65, -0.58, -0.07, 0.2, 0.5])
    rough = PiecewiseLinear(at, np.array([2.0, 0.4, 1.1, 0.0, 0.7, 0.3, 1.9]), 1.8)
    for load in (0.1, 0.5, 1.0, 1.5):
        scene = contact.Scene(rough, E, PERIODIC, load=load)
        slip = contact.partial_slip(contact.solve(scene), MU, 0.5 * MU * load)
        assert 0.0 < slip.dissipated_error < 1e-4 * slip.dissipated < math.inf


def test_a_wrong_friction_is_noticed():
    """The comparison with the grid distinguishes the friction 0.4 from 0.38."""
    solution = contact.solve(contact.Scene(TWO, 1.0, PERIODIC, load=6e-3), tol=1e-8)
    grid = FrictionGrid(512, TWO.height, MU)
    grid.step(6e-3, 0.0)
    grid.step(6e-3, 0.6 * MU * 6e-3)
    wrong = contact.partial_slip(solution, 0.95 * MU, 0.6 * MU * 6e-3)
    far = np.abs(wrong.shear(grid.x) - grid.q).mean() / MU / solution.max_pressure
    assert far > 2e-3 and abs(grid.shift / wrong.shift - 1) > 3e-3


def test_stick_and_slip_zones_together_are_the_contact():
    for route in ("two zones", "gaps"):
        solution = ROUTES[route]()
        slip = contact.partial_slip(solution, MU, 0.3 * MU * solution.load)
        both = np.concatenate((slip.stick_zones, slip.slip_zones))
        assert np.diff(both).sum() == pytest.approx(np.diff(solution.zones).sum(), rel=1e-12)
        assert slip.error < 1e-7


def test_a_load_on_the_verge_of_sliding_slips_everywhere(cylinder):
    slip = contact.partial_slip(cylinder, MU, -MU * cylinder.load)
    assert slip.slides and np.array_equal(slip.slip_zones, cylinder.zones)
    assert np.allclose(slip.shear(X), -MU * cylinder.pressure(X))
    punch = ROUTES["punch"]()
    held = contact.partial_slip(punch, MU, 0.999 * MU * punch.load)
    assert np.array_equal(held.stick_zones, punch.zones) and len(held.slip_zones) == 0


def test_rounded_contacts_under_tiny_loads_leave_the_error_small():
    """Close to full sliding, the stick zone is the contact under a load as small as round-off."""
    profile = contact.Biquadratic(1.0, 0.4)
    scene = contact.Scene(profile, 1.0, ISOLATED, load=1.0)
    history = [(1e-3, 0.2e-3), (1e-3, MU * 1e-3), (2e-3, -MU * 2e-3), (1e-3, 1e-4)]
    for slip in contact.load_history(scene, MU, history, tol=1e-9):
        assert slip.error < 1e-8
    solution = contact.solve(scene.under("load", 1e-3), tol=1e-9)
    near = contact.partial_slip(solution, MU, MU * 1e-3 * (1 - 1e-11), tol=1e-9)
    assert near.error < 1e-8 and not near.slides


def test_no_tangential_load_means_no_shear(cylinder):
    for slip in (contact.partial_slip(cylinder, MU, 0.0), contact.rolling(cylinder, MU, 0.0)):
        assert not slip.shear(X).any() and len(slip.slip_zones) == 0
        assert np.array_equal(slip.stick_zones, cylinder.zones)


SCENES = {
    "another tilt": {"load": 0.1, "moment": 1e-3},
    "different kernels": {"load": 0.1, "substrate": contact.Layer(thickness=1.0, nu=0.3)},
    "law": {"load": 0.1, "law": contact.JKR(1e-3)},
    "nominal pressure": {"mean_pressure": 1.0, "interaction": contact.Localized()},
}


@pytest.mark.parametrize("what", SCENES)
def test_a_scene_whose_shear_is_not_known_is_refused_by_name(what):
    given = dict(SCENES[what])
    model = given.pop("interaction", ISOLATED)
    scene = contact.Scene(WAVE if model is not ISOLATED else CYLINDER, E, model, **given)
    with pytest.raises(contact.SceneError, match=what):
        contact.load_history(scene, MU, [(1.0, 0.1)])


def test_values_out_of_range_are_refused_by_name(cylinder):
    wave = ROUTES["wave"]()
    for solution, given, what in (
        (wave, {"bulk_stress": 1.0}, "grows from period to period"),
        (cylinder, {"tangential_load": 0.0, "bulk_stress": 1.0}, "bulk_stress"),
        (cylinder, {"tangential_load": 1.001 * MU * cylinder.load}, "at most friction"),
        (cylinder, {"friction": -0.1}, "friction"),
        (cylinder, {"friction": 0.0}, "friction"),
        (cylinder, {"tangential_load": np.nan}, "tangential_load"),
        (None, {}, "solution"),
    ):
        with pytest.raises(contact.SceneError, match=what):
            contact.partial_slip(solution, **{"friction": MU, "tangential_load": 1e-5, **given})


def test_scenes_and_data_that_cannot_roll_are_refused_by_name(cylinder):
    for solution, given, what in (
        (cylinder, {}, "one of them"),
        (cylinder, {"creepage": 0.1, "tangential_load": 0.0}, "one of them"),
        (cylinder, {"creepage": 0.1, "leading": "up"}, "leading"),
        (ROUTES["wave"](), {"creepage": 0.1}, "periodic"),
        (ROUTES["punch"](), {"creepage": 0.1}, "sharp corner"),
    ):
        with pytest.raises(contact.SceneError, match=what):
            contact.rolling(solution, MU, **given)


@pytest.mark.parametrize(
    ("history", "what"),
    [([], "at least one"), ([(1.0,)], "list"), ([(1.0, 0.1), (1.0, 0.5)], r"history\[1\]")],
)
def test_a_bad_history_is_refused_by_name(cylinder, history, what):
    with pytest.raises(contact.SceneError, match=what):
        contact.load_history(cylinder.scene, MU, history)


def test_a_slip_is_kept_in_files_tables_and_pickles(tmp_path):
    solution = ROUTES["two zones"]()
    slip = contact.partial_slip(solution, MU, 0.5 * MU * solution.load)
    x = np.linspace(-0.5, 0.5, 33)
    again = pickle.loads(pickle.dumps(slip))
    assert np.array_equal(again.shear(x), slip.shear(x))
    assert again.dissipated == slip.dissipated
    rolled = contact.rolling(solved(half_width=HALF), MU, creepage=0.01)
    assert np.array_equal(pickle.loads(pickle.dumps(rolled)).shear(X), rolled.shear(X))
    plain = slip.to_dict()
    assert plain["stick_zones"] == slip.stick_zones.tolist() and plain["creepage"] is None
    assert plain["solution"]["zones"] == solution.zones.tolist()
    slip.save(tmp_path / "slip.json")
    slip.save(tmp_path / "slip.nc")
    slip.save_fields(tmp_path / "fields.csv")
    slip.save_zones(tmp_path / "zones.csv")
    with pytest.raises(contact.SceneError):
        slip.save(tmp_path / "slip.json")
    rows = (tmp_path / "zones.csv").read_text().splitlines()
    assert rows[0] == "left,right,width,state" and len(rows) == 1 + 1 + 3
    assert {"shear", "stick_zones", "pressure"} <= set(slip.to_dataset().data_vars)
    assert "stick" in slip.summary and "<img" in slip._repr_html_()


def test_at_corners_the_shear_is_infinite_with_the_sign_that_it_has_beside_them():
    punch = contact.solve(contact.Scene(contact.Flat(1.0), 1.0, contact.Isolated(), load=1.0))
    for share in (0.5, -0.5):
        slip = contact.partial_slip(punch, 0.3, 0.3 * share)
        assert slip.shear([-0.5, 0.5]).tolist() == [math.copysign(np.inf, share)] * 2
        beside = slip.shear([-0.5 + 1e-6, 0.5 - 1e-6])
        np.testing.assert_allclose(beside, 0.3 * share * punch.pressure(0.5 - 1e-6), rtol=1e-5)
