"""Every example runs, agrees with known results and has at most forty lines. Every scene file is
solved to its tolerance.
"""

from __future__ import annotations

import importlib.util
import re
from collections import Counter
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import contact
from contact.derivatives.places import tops
from contact.model import registry
from docs.pictures import numbers
from tests.tiers import quick

FOLDER = Path(__file__).parents[1] / "examples"
DOCS = FOLDER.parent / "docs"
SCRIPTS = sorted(FOLDER.glob("*.py"))
SCENES = sorted(FOLDER.glob("*.toml"))


def module(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"examples_{name}", FOLDER / f"{name}.py")
    assert spec is not None and spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


@pytest.fixture
def own_names():
    """The names that an example registers are removed after the test."""
    registries = (registry.PROFILES, registry.INTERACTIONS, registry.SUBSTRATES, registry.LAWS)
    before = [set(known.all()) for known in registries]
    yield
    for known, names in zip(registries, before, strict=True):
        for name in set(known.all()) - names:
            known.forget(name)


@pytest.mark.parametrize("script", [*SCRIPTS, *SCENES], ids=lambda f: f.stem)
def test_an_example_has_at_most_forty_lines_and_a_picture(script: Path) -> None:
    assert len(script.read_text(encoding="utf-8").splitlines()) <= 40
    picture = (DOCS / "gallery" / f"{script.stem}.png").read_bytes()
    assert picture.startswith(b"\x89PNG") and len(picture) <= 60_000


NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


def differing(said: str, printed: str) -> list[tuple[str, str]]:
    """Differences between two printed texts: pairs of numbers that differ by more than
    round-off, and both texts if their words differ.
    """
    ours, theirs = (
        (NUMBER.sub("", text).split(), NUMBER.findall(text)) for text in (said, printed)
    )
    far = [
        (a, b)
        for a, b in zip(ours[1], theirs[1], strict=False)
        if max(abs(float(a)), abs(float(b))) > 1e-8
        and abs(float(a) - float(b)) > 1e-3 * abs(float(a)) + 2e-4
    ]
    return (
        far if ours[0] == theirs[0] and len(ours[1]) == len(theirs[1]) else [*far, (said, printed)]
    )


def test_prints_that_differ_by_more_than_rounding_are_noticed() -> None:
    assert differing("a 1.000000 3e-13", "a 1.000001 9e-12") == []
    assert differing("a 1.0", "a 1.1") and differing("a 1.0", "b 1.0")


# Upper limits of (solves of the linear system, modes of one solution, kernel evaluations,
# positions at which a profile is evaluated). They are about three times the measured counts. A
# change that makes an example slow multiplies its counts by ten or more.
COUNTS = {
    "adhesion": (300, 300, 1e6, 6e5),
    "alike": (100, 500, 1e5, 1e6),
    "even_pressure": (50, 300, 1e5, 1e6),
    "compare_models": (100, 72, 1e4, 1e5),
    "designed_texture": (36, 240, 3e4, 2e4),
    "flat_punch": (100, 48, 1e3, 4e3),
    "plateau": (200, 300, 1e6, 1e6),
    "identify": (300, 300, 1e6, 1e6),
    "own_condition": (27, 48, 4e3, 2e4),
    "own_interaction": (9, 72, 1e3, 1e4),
    "own_law": (3, 48, 3e2, 1e4),
    "own_profile": (6, 72, 1e2, 3e4),
    "own_substrate": (100, 300, 1e6, 1e5),
    "registration": (900, 150, 1e5, 1e5),
    "rounded_punch": (24, 48, 1e2, 2.5e5),
    "textures": (900, 400, 1e5, 1e6),
    "fretting": (60, 700, 3e5, 5e5),
    "stiff_joint": (100, 300, 1e5, 1e6),
    "wheel": (60, 300, 3e4, 5e5),
    "stylus_yield": (10, 300, 1e4, 2e6),
    "sliding_roller": (60, 48, 3e3, 6e5),
    "tilted_punch": (120, 48, 1e3, 1e5),
    "yielding": (300, 600, 3e6, 6e6),
    "two_zones": (50, 120, 3e4, 1e4),
    "adhesive": (300, 300, 1e6, 1e6),
    "hertz": (6, 48, 1e2, 3e4),
    "localized": (10, 96, 3e3, 4e3),
    "punch": (100, 48, 1e3, 4e3),
    "stylus-ground": (12, 3700, 1e7, 2e6),
    "stylus": (10, 300, 1e4, 2e6),
    "two-bodies": (100, 700, 5e5, 2e6),
    "wave": (6, 48, 3e2, 2e3),
}


@pytest.fixture
def work(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """The work done by `contact.solve`: the counts in the plans of its solutions, and the number
    of positions at which their profiles were evaluated.
    """
    spent: Counter[str] = Counter()
    solve = contact.solve

    def counted(function):
        def asked(self, x):
            spent["places"] += np.size(x)
            return function(self, x)

        return asked

    def counting(scene, *args, **kwargs):
        cls = type(scene.profile)
        for name in {"height", "slope", "slope_conjugate"} & set(cls.__dict__):
            if not hasattr(cls.__dict__[name], "counts"):
                method = counted(cls.__dict__[name])
                method.counts = True
                monkeypatch.setattr(cls, name, method)
        solution = solve(scene, *args, **kwargs)
        for name in ("solves", "kernel_evaluations"):
            spent[name] += solution.plan.counts.get(name, 0)
        spent["own_modes"] = max(spent["own_modes"], solution.plan.counts.get("own_modes", 0))
        return solution

    monkeypatch.setattr(contact, "solve", counting)
    return spent


def assert_within(name: str, spent: Counter[str]) -> None:
    for kind, most in zip(
        ("solves", "own_modes", "kernel_evaluations", "places"), COUNTS[name], strict=True
    ):
        # A single zone is solved by one series, without kernel evaluations.
        assert (spent[kind] > 0 or kind == "kernel_evaluations") and spent[kind] <= most, (
            f"{kind}: {spent[kind]} for {most:g}"
        )


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda f: f.stem)
def test_an_example_takes_no_more_work_than_it_is_stated_to_and_prints_what_its_page_says(
    script: Path, work: Counter[str], own_names: None, capsys: pytest.CaptureFixture[str]
) -> None:
    module(script.stem).main()
    assert_within(script.stem, work)
    said = (DOCS / "gallery" / f"{script.stem}.txt").read_text(encoding="utf-8")
    assert differing(said, capsys.readouterr().out) == []


@pytest.mark.parametrize("scene", SCENES, ids=lambda f: f.stem)
def test_a_scene_file_is_solved_to_the_tolerance_with_a_certificate(
    scene: Path, work: Counter[str]
) -> None:
    solution = contact.solve(contact.load_scene(scene))
    assert solution.error <= 1e-8
    assert solution.certificate.holds
    assert_within(scene.stem, work)
    assert (
        differing(
            (DOCS / "gallery" / f"{scene.stem}.txt").read_text(encoding="utf-8"), numbers(solution)
        )
        == []
    )


def test_the_rounded_wedge_carries_the_load_of_its_closed_form(own_names) -> None:
    solution = module("own_profile").main()
    # For one symmetric zone P = (E*/2) int f' x / sqrt(a^2 - x^2) dx, here by Gauss-Chebyshev
    # quadrature with x = a t.
    a, t = solution.zones[0, 1], np.cos((np.arange(400) + 0.5) * np.pi / 800)
    load = 0.5e11 * np.pi * a * np.mean(solution.scene.profile.slope(a * t) * t)
    assert load == pytest.approx(solution.load, rel=1e-12)
    assert solution.scene.profile.slope(a) > 0


def test_a_coat_on_a_base_that_hardly_yields_is_a_bonded_layer(own_names) -> None:
    coats = module("own_substrate").Coats
    q = np.geomspace(3e6, 3e7, 9)
    assert coats((1e-6,), (1e-9,)).symbol(q) == pytest.approx(
        contact.Layer(1e-6, 0.3).symbol(q), rel=1e-8
    )
    assert np.abs(coats((1e-6, 2e-6), (1.0, 1.0)).symbol(q) - 1).max() < 1e-14
    assert contact.testing.check_substrate(coats((1e-6, 2e-6), (2.0, 4.0))).ok


def test_the_rounded_punch_carries_the_load_of_its_closed_form() -> None:
    # With sin(phi) = b/a the load is P = (E* b^2/4 R) ((pi - 2 phi)/sin(phi)^2 - 2 cot(phi)) (M.
    # Ciavarella, D. A. Hills, G. Monno, Proc. IMechE C 212 (1998) 319, doi
    # 10.1243/0954406981521259).
    for solution in module("rounded_punch").main():
        a = solution.zones[0, 1]
        phi = np.arcsin(1e-3 / a)
        load = 1e11 * 1e-6 / (4 * 5e-3) * ((np.pi - 2 * phi) / np.sin(phi) ** 2 - 2 / np.tan(phi))
        # Just beyond the flat part, the load is proportional to (a/b - 1)^(3/2). So the error of
        # a is magnified by 1 / (a/b - 1).
        assert load == pytest.approx(solution.load, rel=1e-12 + 4 * solution.error / (1e3 * a - 1))


def test_two_tips_come_into_contact_apart_and_merge() -> None:
    solutions = module("two_zones").main()
    assert [len(s.zones) for s in solutions] == [2, 2, 2, 1, 1]
    assert np.all(np.diff([s.contact_fraction for s in solutions]) > 0)
    assert np.all(np.diff([s.mean_gap for s in solutions]) < 0)


def test_textures_under_one_pressure_differ_as_their_page_says() -> None:
    found = module("textures").main()
    for name in ("wave", "two tips", "wedge", "rounded flats"):
        along = [found[name, pressure] for pressure in (1e7, 1e8, 5e8)]
        assert np.all(np.diff([one.contact_fraction for one in along]) > 0) and np.all(
            np.diff([one.mean_gap for one in along]) < 0
        )
    # A wave: H. M. Westergaard, J. Appl. Mech. 6 (1939) A49.
    wave = found["wave", 5e8]
    assert wave.mean_pressure == pytest.approx(
        np.pi * 1.1e11 * 5e-3 * np.sin(np.pi * wave.contact_fraction / 2) ** 2, rel=1e-9
    )


def test_two_faces_mate_where_the_tips_of_one_stand_in_the_valleys_of_the_other() -> None:
    found = module("registration").main()
    assert [len(s.zones) for s in found] == [1] * 8 + [3]
    assert np.all(np.diff([s.mean_gap for s in found]) < 0)
    # Both faces are symmetric, so the opposite shift gives the mirror image of the zone.
    pair = found[5].scene.profile
    beyond = contact.Combined(pair.profile, pair.counter, -pair.shift)
    other = contact.solve(
        contact.Scene(beyond, 1.1e11, contact.Periodic(), mean_pressure=1e8), tol=1e-9
    )
    assert other.zones[0] == pytest.approx(-found[5].zones[0, ::-1], abs=1e-12)


def test_models_come_closer_to_the_exact_one_with_every_neighbour_they_keep() -> None:
    table = module("compare_models").main()
    names = ["isolated", "localized, self-consistent", "one neighbour each side"]
    for fraction in (0.2, 0.5):
        off = [abs(table[fraction, name] / table[fraction, "exact"] - 1) for name in names]
        assert off[0] > off[1] > off[2]
    assert np.isnan(table[0.7, "isolated"])
    exact = np.pi * 1.1e11 * 1e-6 * np.sin(np.pi * 0.5 / 2) ** 2
    assert table[0.5, "exact"] == pytest.approx(exact, rel=1e-12)


def test_a_designed_texture_shares_its_load_among_more_zones_as_the_load_grows() -> None:
    solutions = module("designed_texture").main()
    assert [len(s.zones) for s in solutions] == [1, 4, 5]
    assert np.all(np.diff([s.stiffness for s in solutions]) > 0)


def test_flat_punches_have_the_pressure_of_their_closed_form() -> None:
    solution, closed = module("flat_punch").main()
    assert np.isinf(solution.max_pressure)
    assert solution.approach == pytest.approx(closed.approach, rel=1e-12)
    t = np.linspace(-0.99, 0.99, 101)
    assert np.max(np.abs(solution.pressure_at(t) / closed.pressure_at(t) - 1)) < 1e-11
    assert np.max(np.abs(solution.pressure_at(t) / closed.pressure_at(t * (1 - 1e-6)) - 1)) > 1e-11


def test_a_punch_lifts_off_one_corner_when_the_load_is_far_off_its_middle() -> None:
    found = module("tilted_punch").main()
    assert [closed.lifted for _, closed in found] == [False, False, False, True]
    for solution, closed in found:
        assert solution.tilt == pytest.approx(closed.tilt, rel=1e-8, abs=1e-15)
        assert solution.zones == pytest.approx(closed.zones, abs=1e-12)


@pytest.mark.slow
def test_a_rough_line_slips_more_the_more_it_is_pulled() -> None:
    slips = sorted(module("fretting").main(), key=lambda slip: slip.tangential_load)
    widths = [float(np.diff(slip.stick_zones).sum()) for slip in slips]
    assert widths == sorted(widths, reverse=True) and len(slips[0].solution.zones) > 5


def test_a_wheel_has_the_creepage_of_carter() -> None:
    *wheels, worn = module("wheel").main()
    for slip in wheels:
        half = 0.5 * slip.solution.zone_widths[0]
        part = slip.tangential_load / (slip.friction * slip.solution.load)
        carter = slip.friction * half / 0.46 * (1 - np.sqrt(1 - part))
        assert slip.creepage == pytest.approx(carter, rel=1e-9)
    assert len(worn.stick_zones) == 2


def test_a_sliding_roller_has_the_closed_form() -> None:
    for solution, half, middle in module("sliding_roller").main():
        assert 0.5 * solution.zone_widths[0] == pytest.approx(half, rel=1e-9)
        assert solution.zones.mean() == pytest.approx(middle, rel=1e-9, abs=1e-12)


def rms_slope(profile: contact.Sampled) -> float:
    """The root mean square slope of the spline. Between knots f'^2 is a polynomial of the degree
    4, which three Gauss points integrate exactly.
    """
    knots = np.append(profile.x, profile.x[0] + profile.period)
    t, weights = np.polynomial.legendre.leggauss(3)
    half, middle = 0.5 * np.diff(knots), 0.5 * (knots[1:] + knots[:-1])
    squares = profile.slope(middle[:, None] + half[:, None] * t) ** 2
    return float(np.sqrt(half @ (squares @ weights) / profile.period))


@pytest.mark.parametrize(
    ("name", "part", "zones"),
    quick([("stylus", 0.003, 6), ("stylus-ground", 0.0155, 84)], [("stylus", 0.003, 6)]),
)
def test_the_trace_touches_where_its_page_says(name: str, part: float, zones: int) -> None:
    scene = contact.load_scene(FOLDER / f"{name}.toml")
    assert scene.control[1] == pytest.approx(
        part * scene.E_star * rms_slope(scene.profile), rel=2e-4
    )
    assert len(contact.solve(scene).zones) == zones


@pytest.mark.slow
def test_designs_are_what_their_pages_say() -> None:
    bumps = module("alike").main()
    assert np.ptp(bumps.solution.zone_loads) < 1e-6 * bumps.solution.load
    found = module("identify").main()
    deviations = np.sqrt(np.diag(found.covariance))
    values = np.append(found.data["profile.cosine"], found.data["material.E_star"])
    assert np.all(np.abs(values - [-1e-6, 1.5e-7, 7e9]) < 3 * deviations)
    plateau = module("plateau").main()
    fractions = [one.contact_fraction for one in plateau.solutions]
    assert np.ptp(fractions) < 0.14 and plateau.optimality < 1e-5
    even = module("even_pressure").main()
    places = tops(even.solution, 7)
    assert len(places) == 4 and np.ptp(even.solution.pressure(places)) < 1e-6 * even.objective
    joint = module("stiff_joint").main()
    assert joint.solution.max_pressure == pytest.approx(2e8, rel=1e-6)
    assert joint.optimality < 1e-6
