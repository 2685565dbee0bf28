"""Stresses inside the body: closed forms, quadrature of the pressure on every route, refusals."""

from dataclasses import dataclass

import numpy as np
import pytest

import contact
import sie
from tests.tiers import quick

ISOLATED, PERIODIC = contact.Isolated(), contact.Periodic()
WAVE = contact.Sinusoid(1e-2, 1.0)
FOURIER = contact.Fourier(1.0, [1e-2, 3e-3, -2e-3, 4e-3], [1e-3, 2e-3, 4e-3, -1e-3])
HEIGHTS = 1e-3 * np.random.default_rng(3).normal(size=24)
TRACE = contact.Sampled(np.arange(24) / 24, HEIGHTS, period=1.0)
HALF_TRACE = contact.Sampled(np.arange(24) / 48, HEIGHTS, period=0.5)
PUNCH = contact.Flat(0.5)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


def solve(profile, interaction=PERIODIC, E=1.0, law=None, **control):
    extra = {} if law is None else {"law": law}
    return contact.solve(contact.Scene(profile, E, interaction, **extra, **control), tol=1e-8)


def tensor(stress):
    return np.array([stress.xx, stress.yy, stress.xy])


def from_transform(value, slope, y):
    """Returns the stresses xx, yy, xy at depth y from the pressure's transform G (`value`) and
    from G'.
    """
    return np.array([value.imag + y * slope.real, value.imag - y * slope.real, -y * slope.imag])


def places(seed, half, count=400):
    rng = np.random.default_rng(seed)
    return half * rng.uniform(-3, 3, count), half * 10 ** rng.uniform(-6, 1.5, count)


def mcewen(x, y):
    """Stresses below a cylinder with p_0 = a = 1 (E. McEwen, Phil. Mag. 40, 1949, 454)."""
    r = np.hypot(1 - x**2 + y**2, 2 * x * y)
    wide, high = r + 1 - x**2 + y**2, r - 1 + x**2 - y**2
    # McEwen's m and n obey m n = x y. The larger of m^2 and n^2 is computed without cancellation,
    # and the other follows from m n.
    m = np.where(wide > high, np.sqrt(0.5 * np.abs(wide)), 0.0)
    m = np.where(wide > high, m, np.abs(x * y) / np.sqrt(0.5 * np.maximum(high, 1e-300)))
    n, total = x * y / m, m**2 + (x * y / m) ** 2
    return np.array(
        [
            2 * y - m * (1 + (y**2 + n**2) / total),
            -m * (1 - (y**2 + n**2) / total),
            -n * (m**2 - y**2) / total,
        ]
    )


@pytest.mark.filterwarnings("ignore::contact.ModelWarning")
def test_a_cylinder_has_the_stresses_of_mcewen():
    x, y = places(0, 1.0)
    found = solve(contact.Parabola(1.0), ISOLATED, E=2.0, half_width=1.0).stress(x, y)
    assert np.abs(tensor(found) - mcewen(x, y)).max() < 1e-12


@pytest.mark.filterwarnings("ignore::contact.ModelWarning")
def test_the_wave_the_punch_and_the_row_of_punches_have_their_closed_forms():
    wave = solve(contact.Sinusoid(1 / np.pi, 1.0), mean_pressure=np.sin(0.9) ** 2)
    expected = [-0.7366381993968, -1.160074070528, -0.244674691854]
    assert tensor(wave.stress(0.4 / np.pi, 0.3 / np.pi)) == pytest.approx(expected, abs=1e-12)
    punch = solve(contact.Flat(2.0), ISOLATED, load=1.0)
    expected = [-0.9850553417499, -0.468597048292, -0.619146459358]
    assert tensor(punch.stress(1.01, 0.01)) == pytest.approx(expected, abs=1e-12)

    row, (x, y) = solve(contact.Flat(0.5, period=1.0), mean_pressure=0.1), places(1, 0.25)
    z = np.pi * (x + 1j * y)
    # The transform is G = pbar cos(z) / sqrt(sin(z - A) sin(z + A)). The branch of this root
    # approaches sin(z) for large Im z.
    root = np.ones(len(z), dtype=complex)
    for end in (-np.pi / 4, np.pi / 4):
        u = z - end
        root *= np.exp(0.5 * (0.5j * np.pi - 1j * u + np.log(-np.expm1(2j * u)) - np.log(2)))
    value = 0.1 * np.cos(z) / root
    slope = np.pi * value * (-np.tan(z) - np.sin(2 * z) / (2 * root**2))
    expected = from_transform(value, slope, y)
    scale = np.abs(value) + y * np.abs(slope)
    assert (np.abs(tensor(row.stress(x, y)) - expected) / scale).max() < 1e-10


@dataclass(frozen=True)
class Case:
    """A scene whose stresses are compared with a quadrature of its pressure."""

    profile: contact.Profile
    control: dict
    fields: str
    interaction: contact.Interaction = PERIODIC
    law: contact.Law | None = None


CASES = {
    "one zone": Case(WAVE, {"mean_pressure": 0.01}, "ClosedFields"),
    "zones": Case(FOURIER, {"mean_pressure": 0.01}, "ZoneFields"),
    "isolated": Case(FOURIER, {"load": 0.01}, "ZoneFields", ISOLATED),
    "gaps": Case(FOURIER, {"mean_pressure": 0.06}, "GapFields"),
    "full": Case(FOURIER, {"mean_pressure": 0.2}, "FullFields"),
    "trace": Case(TRACE, {"mean_pressure": 0.003}, "ZoneFields"),
    "trace by gaps": Case(TRACE, {"mean_pressure": 0.05}, "GapFields"),
    "trace in full contact": Case(TRACE, {"mean_pressure": 0.5}, "FullFields"),
    "kink": Case(contact.Wedge(0.02, period=1.0), {"mean_pressure": 0.03}, "GapFields"),
    "bends": Case(contact.Biquadratic(1.0, 0.4, period=1.0), {"mean_pressure": 0.1}, "GapFields"),
    "power": Case(contact.Power(0.05, 1.5, period=1.0), {"mean_pressure": 0.1}, "GapFields"),
    "two bodies": Case(
        contact.Combined(FOURIER, HALF_TRACE, shift=0.123), {"mean_pressure": 0.8}, "FullFields"
    ),
    "mirrored": Case(
        contact.Combined(FOURIER, HALF_TRACE, shift=0.123, mirrored=True),
        {"mean_pressure": 0.8},
        "FullFields",
    ),
    "JKR": Case(contact.Parabola(1.0), {"load": 1e-3}, "ZoneFields", ISOLATED, contact.JKR(1e-5)),
    "Dugdale": Case(
        WAVE, {"mean_pressure": 0.01}, "CohesiveFields", law=contact.Dugdale(1e-5, 2e-3)
    ),
    "apart": Case(
        WAVE, {"mean_pressure": -5e-4}, "CohesiveFields", law=contact.Dugdale(1e-5, 2e-3)
    ),
    "Dugdale at corners": Case(
        PUNCH, {"load": 1e-3}, "CohesiveFields", ISOLATED, contact.Dugdale(1e-5, 5e-3)
    ),
}


def cuts_towards(lo, hi, centre, least, ends):
    """Returns the ends of panels that cover (lo, hi). They are short near `centre` and next to
    `ends`.
    """
    steps = least * 2.0 ** np.arange(60)
    fine = 1e-15 * 4.0 ** np.arange(26)
    cuts = [np.linspace(lo, hi, 65), centre + steps, centre - steps, [centre]]
    for end in ends:
        cuts += [end + fine, end - fine, [end]]
    every = np.unique(np.concatenate(cuts))
    return every[(every >= lo) & (every <= hi)]


def rule(cuts):
    half = 0.5 * np.diff(cuts)
    return (cuts[:-1, None] + half[:, None] * (1 + NODES)).ravel(), (
        half[:, None] * WEIGHTS
    ).ravel()


def from_pressure(solution, x, y):
    """Returns the stresses at one point, by quadrature of the pressure on the surface over
    panels.
    """
    scene = solution.scene
    period = scene.period
    shifts = np.zeros(1) if period is None else period * np.arange(-2, 3)
    known = np.concatenate((scene.profile.breakpoints, scene.profile.kinks[:, 0]))
    known = np.append(known, np.asarray(scene.profile.algebraic_points)[:, 0])
    breaks = (np.append(known, solution.cohesive)[:, None] + shifts).ravel()
    if len(solution.zones) == 0 or len(solution.cohesive) > 0 and scene.profile.support is None:
        ends = np.append(breaks, (solution.zones.ravel()[:, None] + shifts).ravel())
        lo, hi = (x - 0.5, x + 0.5) if period else (ends.min(), ends.max())
        xi, weight = rule(cuts_towards(lo, hi, x, y / 4, ends))
        return _summed(xi, weight * solution.pressure(xi), x, y, period)
    total = np.zeros(3)
    for zone, (a, b) in enumerate(solution.zones):
        middle, half = 0.5 * (a + b), 0.5 * (b - a)
        nearest = x if period is None else sie.nearest_image(np.array(x), middle, period)
        angles = np.arccos(np.clip((np.append(breaks, nearest) - middle) / half, -1, 1))
        inner = np.unique(angles[:-1][(angles[:-1] > 0) & (angles[:-1] < np.pi)])
        angle, weight = rule(cuts_towards(0, np.pi, angles[-1], min(y / half / 8, 0.05), inner))
        pressure = solution.pressure_at(np.cos(angle), zone)
        # In the shortest panels a node may round to a kink, where the pressure is infinite.
        force = weight * half * np.sin(angle) * np.where(np.isinf(pressure), 0.0, pressure)
        total += _summed(middle + half * np.cos(angle), force, x, y, period)
    return total


def _summed(xi, force, x, y, period):
    z = x + 1j * y - xi
    if period is None:
        return from_transform(force @ (1 / z) / np.pi, -force @ (1 / z**2) / np.pi, y)
    u = np.pi * z / period
    value = force @ (1 / np.tan(u)) / period
    return from_transform(value, -np.pi * (force @ (1 / np.sin(u) ** 2)) / period**2, y)


QUICK = ("zones", "gaps", "full", "trace by gaps", "kink", "mirrored", "JKR", "Dugdale")


@pytest.mark.parametrize("name", quick(CASES, QUICK))
def test_stresses_are_those_of_the_pressure_on_every_route(name):
    case = CASES[name]
    solution = solve(case.profile, case.interaction, law=case.law, **case.control)
    assert type(solution.fields).__name__ == case.fields
    first = solution.zones[-1] if len(solution.zones) else np.array([-0.3, 0.2])
    for part, depth in ((0.1, 0.01), (0.7, 0.1), (-1.2, 0.4), (1.01, 1e-3), (0.4, 3.0)):
        x, y = first.mean() + part * np.ptp(first), depth * np.ptp(first)
        found = solution.stress(x, y)
        difference = np.abs(tensor(found) - from_pressure(solution, x, y)).max()
        assert difference <= found.error
        assert found.error < 1e-7 * (np.abs(tensor(found)).max() + solution.fields.load)


@pytest.mark.parametrize("name", quick(CASES, ("isolated", "power", "Dugdale at corners")))
def test_the_surface_carries_the_pressure_and_no_shear(name):
    case = CASES[name]
    solution = solve(case.profile, case.interaction, law=case.law, **case.control)
    x = np.linspace(-0.493, 0.487, 41)
    found = solution.stress(x, 0.0)
    assert np.all(np.abs(found.yy + solution.pressure(x)) <= found.error)
    assert np.array_equal(found.xx, found.yy) and not found.xy.any()


@pytest.mark.parametrize("neighbours", [0, 1])
def test_a_localized_strip_is_between_nominal_pressures(neighbours):
    model = contact.Localized("self-consistent", neighbours=neighbours)
    solution = solve(WAVE, model, mean_pressure=0.01)
    (a, b), half = solution.zones[0], neighbours + 0.5
    for x, y in ((0.1, 0.05), (0.3, 0.4)):
        angle = np.pi * (np.arange(2000) + 0.5) / 2000
        xi = 0.5 * (a + b) + 0.5 * (b - a) * np.cos(angle)
        force = 0.5 * (b - a) * np.sin(angle) * solution.pressure_at(np.cos(angle)) * np.pi / 2000
        expected = sum(
            _summed(xi + shift, force, x, y, None) for shift in range(-neighbours, neighbours + 1)
        )
        # Outside the strip the nominal pressure 0.01 acts: its field is that of a uniform
        # pressure on the whole surface minus that of the same pressure on the strip.
        left, right = x + 1j * y + half, x + 1j * y - half
        value = -0.01 * (1j + np.log(left / right) / np.pi)
        expected += from_transform(value, -0.01 / np.pi * (1 / left - 1 / right), y)
        assert tensor(solution.stress(x, y)) == pytest.approx(expected, abs=1e-12)


def test_lateral_chooses_the_lateral_support_of_the_body():
    solution = solve(WAVE, mean_pressure=0.01)
    deep = {
        name: solution.stress(0.2, 50.0, name, nu=0.3) for name in ("as loaded", "free", "confined")
    }
    assert {name: round(float(one.xx), 12) for name, one in deep.items()} == {
        "as loaded": -0.01,
        "free": 0.0,
        "confined": round(-0.01 * 0.3 / 0.7, 12),
    }
    assert all(abs(one.yy + 0.01) < 1e-15 for one in deep.values())
    confined = deep["confined"]
    strain = confined.xx - 0.3 * (confined.yy + confined.zz(0.3))
    assert abs(strain) < 1e-15


def test_equivalent_stresses_follow_from_the_principal_ones():
    found = solve(contact.Parabola(1.0), ISOLATED, load=1e-3).stress(0.01, 0.02)
    matrix = np.diag([0.0, 0.0, float(found.zz(0.25))])
    matrix[:2, :2] = [[found.xx, found.xy], [found.xy, found.yy]]
    principal = np.linalg.eigvalsh(matrix)
    differences = principal - np.roll(principal, 1)
    assert found.mises(0.25) == pytest.approx(np.sqrt(0.5 * (differences**2).sum()))
    assert found.tresca(0.25) == pytest.approx(0.5 * np.ptp(principal))
    plane = np.linalg.eigvalsh(matrix[:2, :2])
    assert found.shear == pytest.approx(0.5 * np.ptp(plane))


def test_wrong_places_and_bodies_are_refused_by_name():
    solution = solve(WAVE, mean_pressure=0.01)
    with pytest.raises(contact.SceneError, match="y = -0.1 is refused"):
        solution.stress([0.0, 1.0], [0.2, -0.1])
    with pytest.raises(contact.SceneError, match="lateral = 'fre' is not known"):
        solution.stress(0.0, 1.0, "fre")
    with pytest.raises(contact.SceneError, match="nu = None is refused"):
        solution.stress(0.0, 1.0, "confined")
    with pytest.raises(contact.SceneError, match="shapes"):
        solution.stress([0.0, 1.0], [1.0, 2.0, 3.0])
    layer = contact.Scene(
        WAVE, 1.0, PERIODIC, substrate=contact.Layer(0.1, 0.3), mean_pressure=0.01
    )
    with pytest.raises(contact.SceneError, match="substrate"):
        contact.solve(layer).stress(0.0, 1.0)


@pytest.mark.filterwarnings("error", "ignore::contact.ModelWarning")
def test_at_a_tip_on_the_surface_the_shear_stress_is_not_a_number():
    scene = contact.Scene(contact.Wedge(0.01), 2.0, contact.Isolated(), half_width=1.0)
    stress = contact.solve(scene).stress([0.0, 0.5], [0.0, 0.0])
    for value in (stress.shear, stress.mises(0.3), stress.tresca(0.3)):
        assert np.isnan(value[0]) and value[1] >= 0.0
