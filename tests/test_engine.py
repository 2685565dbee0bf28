"""Examples of the engine `sie`: their results agree with closed forms or with other methods."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import sie

ROOT = Path(__file__).parents[1]
SCRIPTS = sorted((ROOT / "examples" / "engine").glob("*.py"))


def run(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(
        f"examples_engine_{name}", ROOT / "examples" / "engine" / f"{name}.py"
    )
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda f: f.stem)
def test_an_example_of_the_engine_is_short_has_a_picture_and_needs_no_contact(script: Path) -> None:
    text = script.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 40 and "contact" not in text
    assert "examples/engine/" in (ROOT / "docs" / "engine.md").read_text(encoding="utf-8")
    assert 0 < (ROOT / "docs" / "gallery" / f"{script.stem}.png").stat().st_size <= 60_000


def test_cracks_have_the_stress_intensity_factors_of_their_closed_forms() -> None:
    found, closed, error = run("cracks").main()
    assert found == pytest.approx(closed, rel=10 * error + 1e-15)
    assert found != pytest.approx(np.array(closed) * (1 + 1e-11), rel=10 * error + 1e-15)


def test_plates_in_tandem_lift_what_the_closed_form_says_and_together_no_more_than_alone() -> None:
    module = run("aerofoils")
    lifts, exact, error = module.main()
    assert lifts == pytest.approx(exact, rel=10 * error + 1e-15)
    chords = np.diff(module.PLATES)[:, 0]
    assert lifts @ chords == pytest.approx(2 * np.pi * module.ALPHA * chords.sum(), rel=1e-12)


def vortices(module: ModuleType, count: int) -> np.ndarray:
    """Lift coefficients by discrete vortices. The vortices are at the quarter points of panels,
    and no flow passes the three-quarter points (R. M. James, Comput. Methods Appl. Mech. Eng. 1
    (1972) 59).
    """
    length = np.diff(module.PLATES) / count
    starts = module.PLATES[:, :1] + length * np.arange(count)
    at, through = (starts + 0.25 * length).ravel(), (starts + 0.75 * length).ravel()
    circulation = np.linalg.solve(
        1 / (through[:, None] - at), np.full(2 * count, 2 * np.pi * module.ALPHA)
    )
    return 2 * circulation.reshape(2, count).sum(axis=1) / np.diff(module.PLATES)[:, 0]


def test_plates_in_tandem_lift_what_discrete_vortices_come_to() -> None:
    module = run("aerofoils")
    lifts, _, _ = module.main()
    coarse, fine = (np.abs(vortices(module, count) / lifts - 1).max() for count in (20, 40))
    assert fine < 0.3 * coarse < 1e-3 or fine < 1e-5


def test_the_two_cuts_end_where_the_closed_form_has_them() -> None:
    found, ends = run("equilibrium").main()
    assert found.zones.table == pytest.approx(np.array([-ends[::-1], ends]), abs=10 * found.error)


def test_the_capacity_of_two_intervals_is_the_elliptic_one() -> None:
    for capacity, closed, error in run("capacity").main():
        assert capacity == pytest.approx(closed, rel=10 * error + 1e-14)


def test_the_stresses_off_the_cracks_are_those_of_the_closed_form() -> None:
    off, error = run("stresses").main()
    assert max(off) < 10 * error


def test_sliding_punches_have_the_intensities_and_ends_of_their_closed_forms() -> None:
    for mu, flat, edge, cylinder, ends in run("sliding_punch").main():
        factors = np.ravel(flat.density.intensities)
        assert factors == pytest.approx(edge, rel=10 * flat.error + 1e-15)
        width = ends[1] - ends[0]
        assert cylinder.zones.table[0] == pytest.approx(ends, abs=10 * cylinder.error * width)
        # The punch moves towards x > 0. With friction, the pressure is more singular at the rear
        # end, x < 0, than at the front end.
        behind, before = np.ravel(flat.density.exponents)
        assert behind + before == pytest.approx(-1.0, abs=1e-14)
        assert (behind < before) == (mu > 0.0) and (ends[0] + ends[1] < -1e-9) == (mu > 0.0)


def test_interface_cracks_have_the_exponents_and_intensities_of_the_closed_form() -> None:
    for beta, one, k, exact, two, of_two in run("interface_crack").main():
        assert k == pytest.approx(exact, rel=10 * one.error + 1e-14)
        eps = np.arctanh(beta) / np.pi
        assert one.density.exponents[1, 0] == pytest.approx(-0.5 + 1j * eps, abs=1e-14)
        assert abs(of_two[0]) > abs(of_two[1]) > abs(k)  # the inner tip is loaded most
        # By symmetry the intensities at the left tips are minus the conjugates of those at the
        # right tips.
        left, right = two.density.intensities
        assert left[0] == pytest.approx(-np.conj(right[1]), rel=1e-10)


def test_a_punch_that_slides_back_is_the_mirrored_one() -> None:
    module = run("sliding_punch")
    edges = sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR)
    (_, there), (_, back) = (module.slid(mu, np.zeros_like, edges) for mu in (0.7, -0.7))
    x = np.linspace(-0.95, 0.95, 21)
    assert there.density(x) == pytest.approx(back.density(-x), rel=1e-11)


def test_porous_plates_with_a_flap_lift_what_the_closed_form_says_and_less_the_more_porous() -> (
    None
):
    module = run("porous_aerofoil")
    rows = module.main()
    for _, found, lift, closed in rows:
        assert lift == pytest.approx(closed, rel=10 * found.error + 1e-14)
    lifts = [lift for _, _, lift, _ in rows]
    assert np.all(np.diff(lifts) < 0)
    # H. Glauert, R. & M. 1095 (1927): turning the flap has the effect of an incidence of
    # (theta + sin theta) / pi times its angle, with cos theta = 2 h - 1 for the hinge at the
    # part h of the chord.
    theta = np.arccos(2 * module.HINGE - 1)
    part = (theta + np.sin(theta)) / np.pi
    assert lifts[0] == pytest.approx(2 * np.pi * (module.INCIDENCE + module.FLAP * part), rel=1e-13)


@pytest.mark.parametrize("row", [1, 2, 3])
def test_the_lift_of_a_porous_plate_is_the_downwash_times_the_adjoint_solution(row: int) -> None:
    module = run("porous_aerofoil")
    kappa, _, lift, _ = module.main()[row]
    alpha = np.arctan2(1.0, kappa) / np.pi
    # The substitution 1 - x = s^(1 / (1 - alpha)) removes the singularity at x = 1.
    power = 1 / (1 - alpha)
    flap = quad(lambda s: (1 - s**power) ** alpha * power, 0, (1 - module.HINGE) ** (1 - alpha))[0]
    whole = np.pi * alpha / np.sin(np.pi * alpha)
    total = 2 * np.sin(np.pi * alpha) * (module.INCIDENCE * whole + module.FLAP * flap)
    assert lift == pytest.approx(2 * total, rel=1e-10)


def test_cracks_beside_a_thin_ligament_have_willmore_s_intensities() -> None:
    rows = run("thin_ligament").main()
    assert [found.zones.a[1] - found.zones.b[0] for found, _, _ in rows] == pytest.approx(
        10.0 ** -np.arange(2.0, 9.0), rel=1e-12
    )
    for found, tips, _ in rows:
        with mpmath.workdps(40):
            k = mpmath.mpf(float(found.zones.a[1]))
            ratio = mpmath.ellipe(1 - k**2) / mpmath.ellipk(1 - k**2)
            size = mpmath.sqrt(mpmath.pi / (1 - k**2))
            exact = [float(size * (1 - ratio)), float(size * (ratio - k**2) / mpmath.sqrt(k))]
        assert found.error < 1e-10
        assert tips == pytest.approx(exact, rel=10 * found.error)
        assert tips != pytest.approx(np.array(exact) * (1 + 1e-9), rel=10 * found.error)


def test_a_cut_splits_where_the_closed_form_has_it() -> None:
    for t, found, ends in run("splitting_cut").main():
        assert found.zones.table.ravel() == pytest.approx(
            np.append(-ends[::-1], ends), abs=20 * found.error
        )
        x = np.linspace(-2.45, 2.45, 40)
        if t > 2:
            density = np.abs(x) * np.sqrt(np.maximum(0, (x**2 - t + 2) * (t + 2 - x**2)))
        else:
            square = ends[0] ** 2
            density = (x**2 + square / 2 - t) * np.sqrt(np.maximum(0, square - x**2))
        assert found.density(x) == pytest.approx(density / (2 * np.pi), abs=1e-11)


def only_cut(middle: float) -> tuple[float, float, float, float]:
    """(total, half width, place, height) for V' = x^3 - 5 x/2 + 3/10 and one cut about `middle`.

    The transform is F = (V' - X M) / (2 pi), with X = sqrt(w^2 - h^2), w = x - m, m = `middle`
    and the half width h. Far away F is total / (pi x), so M = w^2 + 3 m w + 3 m^2 - 5/2 + h^2/2
    and h^2 = -2 V'(m) / (3 m). The place is the last root of M. The height is the potential
    minus V / (2 pi) at this place, less its level on the cut.
    """
    square = -2 * (middle**3 - 2.5 * middle + 0.3) / (3 * middle)
    total = (3 * middle**2 - 2.5) * square / 4 + 3 * square**2 / 16
    half, constant = np.sqrt(square), 3 * middle**2 - 2.5 + square / 2
    last = 0.5 * (-3 * middle + np.sqrt(9 * middle**2 - 4 * constant))
    # w = h cosh(s) makes the integrand smooth.
    height = quad(
        lambda s: ((half * np.cosh(s)) ** 2 + 3 * middle * half * np.cosh(s) + constant)
        * square * np.sinh(s) ** 2, 0, np.arccosh(last / half), epsabs=1e-13,
    )[0]  # fmt: skip
    return total, half, middle + last, -height / (2 * np.pi)


def test_a_cut_is_born_where_the_other_well_reaches_the_level() -> None:
    birth, at, rows = run("birth_of_a_cut").main()
    middle = brentq(lambda m: only_cut(m)[3], -1.61, -1.55, xtol=1e-15)
    total, half, place, _ = only_cut(middle)
    assert birth == pytest.approx(total, rel=1e-11)
    assert at == pytest.approx(place, rel=1e-10)
    # Just after the birth, the first cut has hardly changed, and the second cut contains the
    # place of the birth.
    first, second = rows[1].zones.table
    assert first == pytest.approx([middle - half, middle + half], abs=1e-3)
    assert second[0] < place < second[1]
    shares = [one.density.totals[1] / one.density.totals.sum() for one in rows[1:]]
    assert np.all(np.diff(shares) > 0) and 0 < shares[0] < 1e-3
    assert rows[0].density.totals.sum() == pytest.approx(0.8 * birth, rel=1e-12)


def test_equations_that_the_engine_does_not_solve_are_refused() -> None:
    for kappa, message in ((lambda x: x, "kappa must be a finite number"), (1j, "-1 < beta < 1")):
        with pytest.raises(ValueError, match=message):
            sie.Equation(sie.cauchy(), np.ones_like, sie.Total(1.0), kappa=kappa)
    complex_kappa = sie.Equation(sie.cauchy(), np.ones_like, sie.Total(1.0), kappa=0.3j)
    with pytest.raises(ValueError, match="ends cannot be free"):
        sie.solve(complex_kappa, sie.Zones.of([[-1.0, 1.0]]))
    with pytest.raises(ValueError, match="a smooth kernel alone"):
        sie.Equation(sie.Smooth(lambda x, xi: np.log(np.abs(x - xi))), np.ones_like)
    with pytest.raises(ValueError, match="strictly ascending"):
        sie.Zones.of([[0.0, 1.0], [1.0, 2.0]], sie.SINGULAR, sie.SINGULAR)
    edge = sie.Smooth(lambda x, xi: 1 / (x + xi) - 6 * x / (x + xi) ** 2 + 4 * x**2 / (x + xi) ** 3)
    equation = sie.Equation(sie.cauchy() + edge, np.ones_like, ())
    with pytest.raises(sie.NotConverged, match="the function varies too fast"):
        sie.solve(equation, sie.Zones.of([[0.0, 1.0]], sie.BOUNDED, sie.SINGULAR))
    inner = sie.Equation(sie.cauchy() + edge, np.ones_like, sie.Total(0.0))
    assert sie.solve(inner, sie.Zones.of([[0.1, 1.0]], sie.SINGULAR, sie.SINGULAR)).error < 1e-9
