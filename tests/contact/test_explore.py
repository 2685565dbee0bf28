"""`contact explore`: its handles, the contents of a frame, and the page in a real browser."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import numpy as np
import pytest

import contact
from contact.explorer import server
from contact.explorer.frame import drawn
from contact.explorer.handles import handles, with_values
from contact.explorer.presets import PRESETS
from contact.explorer.server import ADDRESS, Given, Reply
from contact.explorer.session import Session
from contact.model.scene_file import scene_from_tables, to_toml
from contact.model.units import quantity, scaled
from tests.browser import CHROMIUM, MISSING, Page, browser

ROOT = Path(__file__).parents[2]
WAVE = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1.1e11, contact.Periodic(), mean_pressure=1.7e9)
TRACE = contact.Sampled(np.linspace(0.0, 1e-4, 41), 1e-7 * np.random.default_rng(5).normal(size=41))
SCENES = {
    "wave": WAVE,
    "layer": replace(WAVE, substrate=contact.Layer(1e-5, 0.3, "smooth")),
    "series": replace(
        WAVE,
        profile=contact.Fourier(1e-4, (1e-6, 0.0, 2e-7), (1e-7,)),
        mean_pressure=None,
        contact_fraction=0.3,
    ),
    "trace": contact.Scene(TRACE, 1e9, contact.Isolated(), load=1.0),
    "turned": contact.Scene(
        contact.Parabola(1e-3), 1e9, contact.Isolated(datum=0.1), tilt=1e-3, load=10.0
    ),
    "adhesion": contact.Scene(
        contact.Parabola(1e-3), 1e9, contact.Isolated(), law=contact.JKR(0.05), load=0.0
    ),
    "strip": replace(WAVE, interaction=contact.Localized("self-consistent", neighbours=2)),
    "punch": contact.Scene(contact.Flat(4e-5, 1e-4), 1e9, contact.Periodic(), load=1e3),
}


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_s_text_is_read_back_as_the_same_scene(name: str) -> None:
    assert scene_from_tables(tomllib.loads(to_toml(SCENES[name]))) == SCENES[name]


def test_a_shape_without_a_name_has_no_text() -> None:
    @dataclass(frozen=True)
    class Own(contact.Profile):
        def height(self, x):
            return np.cosh(x)

    with pytest.raises(contact.SceneError, match="register_profile"):
        to_toml(contact.Scene(Own(), 1e9, contact.Isolated(), load=1.0))


@pytest.mark.parametrize("name", SCENES)
def test_handles_that_are_not_moved_leave_the_scene_as_it_is(name: str) -> None:
    scene = SCENES[name]
    known = handles(scene)
    assert known[0].name == scene.control[0]
    assert len({handle.name for handle in known}) == len(known)
    assert with_values(scene, {handle.name: handle.value for handle in known}, known) is scene
    assert all(handle.low <= handle.value <= handle.high or handle.whole for handle in known)


@pytest.mark.parametrize("name", ["wave", "series", "trace"])
def test_amplitude_and_length_of_a_shape_scale_it_however_it_is_given(name: str) -> None:
    scene = SCENES[name]
    known = {handle.name: handle for handle in handles(scene)}
    length = known["length" if name == "trace" else "period"]
    moved = with_values(
        scene,
        {"amplitude": 3 * known["amplitude"].value, length.name: 2 * length.value},
        tuple(known.values()),
    ).profile
    x = np.linspace(0.0, 1e-4, 23)
    away = moved.height(2 * x) - 3 * scene.profile.height(x)
    assert np.ptp(away) < 1e-12 * known["amplitude"].value * 3


def test_samples_of_a_shape_are_points_on_it() -> None:
    sampled = with_values(WAVE, {"samples": 16}, handles(WAVE)).profile
    assert len(sampled.x) == 16
    assert np.ptp(sampled.height(sampled.x) - WAVE.profile.height(sampled.x)) < 1e-20
    assert np.ptp(sampled.height(sampled.x + 3e-6) - WAVE.profile.height(sampled.x + 3e-6)) > 1e-12


def session(scene: contact.Scene | str, is_awaited: Callable[[], bool] = lambda: False) -> Session:
    """The session of a browser tab, for a scene or for the text of a scene file."""
    if isinstance(scene, contact.Scene):
        return Session(Given(scene), 1e-8, is_awaited)
    tables = tomllib.loads(scene)
    return Session(Given(scene_from_tables(tables), tables), 1e-8, is_awaited)


def ask(tab: Session, ask: str, **request: Any) -> dict[str, Any]:
    """The reply of a session to a request: header and arrays in one dict."""
    header, arrays = tab.reply({"ask": ask, **request})
    return {**header, **arrays}


def said(reply: dict[str, Any]) -> dict[str, str]:
    """The numbers of a reply as text, by their names."""
    return dict(map(tuple, reply["numbers"]))


MATERIALS = PRESETS["sliding"].text


def test_materials_are_shown_as_they_were_entered() -> None:
    tab = session(MATERIALS)
    shown = {one["name"]: one["value"] for one in ask(tab, "begin")["sliders"]}
    assert {name: shown[name] for name in ("E1", "nu1", "E2", "nu2")} == {
        "E1": 5e6,
        "nu1": 0.35,
        "E2": 210e9,
        "nu2": 0.3,
    }
    assert not {"E_star", "beta"} & set(shown)
    reply = ask(tab, "frame", values={"E1": 2e7, "nu1": 0.4}, fine=True)
    solved = tab.solution.scene
    assert solved.E_star == contact.E_star(2e7, 0.4, 210e9, 0.3)
    assert solved.law.beta == contact.dundurs_beta(2e7, 0.4, 210e9, 0.3)
    material = tomllib.loads(reply["text"])["material"]
    assert material == {"E1": 2e7, "nu1": 0.4, "E2": 210e9, "nu2": 0.3}
    assert "2.1e11" in reply["text"] and "beta" not in reply["text"]
    assert scene_from_tables(tomllib.loads(reply["text"])) == solved


def agrees(text: str, value: float, unit: str) -> bool:
    """Whether a text such as "1.0725 ± 0.0002 µm" has this value and unit, to four digits."""
    if not np.isfinite(value):
        return text == "infinite"
    factor, name = scaled(abs(value), unit)
    number = float(text.split()[0])
    return text.endswith(name) and abs(number - value * factor) <= 5e-4 * abs(value * factor)


@pytest.mark.parametrize("value", [2.1e11, -3e6, 1234000000.0, 123456789.0, 1e22, 0.1, 5.0])
def test_large_numbers_of_a_scene_file_are_short_and_exact(value: float) -> None:
    scene = replace(WAVE, E_star=abs(value), mean_pressure=None, load=1.0)
    text = to_toml(scene)
    assert tomllib.loads(text)["material"]["E_star"] == abs(value)
    assert "00000.0" not in text


@pytest.mark.parametrize("name", SCENES)
def test_a_frame_shows_the_fields_of_its_solution(name: str) -> None:
    found = drawn(contact.solve(SCENES[name]))
    x, body, surface, touching, pressure = found.fields
    assert (np.diff(x) >= 0).all() and np.isfinite([x, body, surface, pressure]).all()
    # The bodies do not overlap. Their surfaces coincide just in the zones, and only there is
    # the pressure not zero.
    room = 1e-6 * (max(body.max(), surface.max()) - min(body.min(), surface.min()))
    assert (body - surface > -room).all()
    inside = np.any((x >= found.zones[:, :1]) & (x <= found.zones[:, 1:]), axis=0)
    assert (np.isfinite(touching) == inside).all() and (np.abs(body - surface)[inside] < room).all()
    assert (pressure[~inside] == 0.0).all() and pressure[inside].max() > 0.0
    assert [name.partition(" ")[0] for name in found.names] == ["x", "height", "pressure"]


def test_infinite_pressure_is_marked_with_its_sign() -> None:
    def marked(scene: contact.Scene) -> tuple[list[float], list[float]]:
        found = drawn(contact.solve(scene)).details
        return found["rising"], found["falling"]

    wedge = contact.Scene(contact.Wedge(0.01, 1e-4), 1e9, contact.Periodic(), mean_pressure=1e6)
    assert marked(wedge) == ([0.0], [])
    assert marked(SCENES["punch"]) == (pytest.approx([-20.0, 20.0]), [])
    ends = contact.solve(SCENES["adhesion"]).zones[0]
    rising, falling = marked(SCENES["adhesion"])
    assert rising == [] and np.ptp(falling) / np.ptp(ends) == pytest.approx(1e6)
    assert marked(WAVE) == ([], [])


def test_finite_tension_is_drawn_to_its_end() -> None:
    law = contact.Dugdale(0.02, 1e5)
    scene = contact.Scene(
        contact.Sinusoid(1e-6, 1e-4), 4e6, contact.Periodic(), law=law, approach=2e-7
    )
    found = drawn(contact.solve(scene))
    assert found.names[2] == "pressure [kPa]"
    assert found.details["range"][0] == pytest.approx(-100.0) == found.fields[4].min()


def test_a_slider_that_moves_shows_the_solution_of_the_text_beside_it() -> None:
    tab = session(WAVE)
    first = ask(tab, "frame")
    moved = ask(tab, "frame", values={"mean_pressure": 5.3e8})
    rest = ask(tab, "frame", values={"mean_pressure": 5.3e8}, fine=True)
    solution = contact.solve(scene_from_tables(tomllib.loads(rest["text"])))
    assert solution.mean_pressure == 5.3e8
    assert tab.solution.zones == pytest.approx(solution.zones, rel=1e-8)
    for reply in (moved, rest):
        shown = said(reply)
        assert agrees(shown["contact fraction"], solution.contact_fraction, "")
        assert agrees(shown["largest pressure"], solution.max_pressure, "Pa")
        assert " ± " in shown["largest pressure"] and " ± " not in shown["load"]
    assert said(first)["mean pressure"] == "1.7 GPa" and said(rest)["mean pressure"] == "530 MPa"
    assert rest["fields"].shape[1] > moved["fields"].shape[1]


def test_a_moving_rough_surface_states_the_error_it_has_and_is_exact_at_rest() -> None:
    tab = session(PRESETS["rough"].text)
    for pressure in (1.0e8, 1.1e8, 1.2e8):
        ask(tab, "frame", values={"mean_pressure": pressure})
        exact = contact.solve(tab.solution.scene, tol=1e-10)
        wrong = np.max(np.abs(tab.solution.zones - exact.zones) / exact.zone_widths[:, None])
        assert wrong <= tab.solution.error <= 1e-4
    ask(tab, "frame", values={"mean_pressure": 1.2e8}, fine=True)
    assert tab.solution.error <= 1e-8


def whole_curve(tab: Session) -> dict[str, Any]:
    while not (reply := ask(tab, "curve"))["done"]:
        pass
    return reply


def test_the_load_curve_stays_while_the_scene_moves_along_it() -> None:
    tab = session(WAVE)
    first = ask(tab, "frame")
    found = whole_curve(tab)
    (points,) = found["advancing"]
    assert found["curve"] == first["curve"] and len(points) > 15 and found["receding"] == []
    x, y, slope = np.array(points[:-1], dtype=float).T
    assert (np.diff(x) > 0).all() and (np.diff(y) > 0).all()
    # The slope of each chord lies between the slopes of the curve at its ends: the curve is
    # convex.
    assert (np.diff(y) / np.diff(x) > slope[:-1]).all()
    assert (np.diff(y) / np.diff(x) < slope[1:]).all()
    assert ask(tab, "frame", values={"mean_pressure": 1e9})["curve"] == first["curve"]
    assert ask(tab, "frame", values={"amplitude": 3e-6})["curve"] != first["curve"]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["JKR", "Dugdale"])
def test_under_adhesion_both_branches_are_there_with_their_jumps(name: str) -> None:
    tab = session(PRESETS[name].text)
    ask(tab, "begin")
    first = ask(tab, "frame", fine=True)
    found = ask(tab, "curve")
    assert found["done"] and len(found["jumps"]) == 2
    (into, out), period = found["jumps"], tab.base.period or 1.0
    # Contact begins with a jump from zero load into tension. It ends with a jump to zero load,
    # at a smaller approach.
    assert into[0][1] == 0.0 > into[1][1] and out[0][1] < 0.0 == out[1][1]
    assert out[0][0] < into[0][0]
    half = 0.5 * (into[0][0] + out[0][0])
    receding = contact.solve(replace(tab.base, approach=half), branch="receding")
    line = max(found["receding"], key=len)
    x, y = np.array([point[:2] for point in line]).T
    at = receding.approach
    assert np.interp(at, x[::-1], y[::-1]) == pytest.approx(receding.load / period, rel=2e-2)
    assert first["here"][0] == pytest.approx(tab.base.approach)


def test_a_load_curve_gives_way_to_a_waiting_request() -> None:
    """The computation of a curve or of a precise solution stops while another request waits."""
    waits = False
    tab = session(PRESETS["rough"].text, lambda: waits)
    ask(tab, "frame", fine=True)
    waits = True
    assert ask(tab, "curve").get("dropped")
    assert ask(tab, "frame", values={"mean_pressure": 1.3e8}, fine=True).get("dropped")
    assert "numbers" in ask(tab, "frame", values={"mean_pressure": 1.3e8})
    waits = False
    assert ask(tab, "curve")["advancing"]


@pytest.mark.parametrize("kind", ["shear", "mises", "fringes"])
def test_the_stress_below_is_that_of_the_solution(kind: str) -> None:
    tab = session(PRESETS["wave"].text)
    reply = ask(tab, "frame", below=kind, columns=40, stretch=[-2e-5, 2e-5], fine=True)
    rows, columns = reply["below"].shape
    details = tab.reply({"ask": "frame", "below": kind, "columns": 40, "fine": True})[0]["below"]
    assert columns == 40 and details["kind"] == kind
    depth = (
        1e-6
        * tab.reply(
            {"ask": "frame", "below": kind, "columns": 40, "stretch": [-2e-5, 2e-5], "fine": True}
        )[0]["below"]["depth"]
    )
    x = -2e-5 + 1e-6 * (np.arange(columns) + 0.5)
    y = depth * (np.arange(rows) + 0.5) / rows
    stress = tab.solution.stress(x, y[:, None])
    expected = stress.mises(0.3) if kind == "mises" else stress.shear
    assert reply["below"] == pytest.approx(expected)
    name = "largest von Mises" if kind == "mises" else "largest shear"
    largest = max(map(float, expected.ravel()))
    assert details["top"] == pytest.approx(largest, rel=2e-2)
    assert said(reply)[name] == quantity(details["top"], "Pa")


def test_a_body_without_stresses_says_so() -> None:
    """The scene of a layer is solved, and the reply says that it has no stresses."""
    reply = ask(session(SCENES["layer"]), "frame", below="shear")
    below = tuple(reply["below"].values()) if isinstance(reply["below"], dict) else ()
    assert (
        any("stresses in the body are not available" in str(part) for part in below)
        and "numbers" in reply
    )


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_is_a_scene(name: str) -> None:
    reply = ask(session(WAVE), "begin", preset=name)
    assert reply["preset"] == name and len(reply["sliders"]) > 3 and reply["about"]
    assert scene_from_tables(tomllib.loads(PRESETS[name].text)).control


def test_an_invalid_scene_is_refused_and_the_last_one_stays() -> None:
    tab = session(SCENES["layer"])
    text = ask(tab, "frame", fine=True)["text"]
    last = tab.solution
    wrong = (
        "[profile",
        "x = 1",
        text.replace('"sinusoid"', '"sinusiod"'),
        text.replace("nu = 0.3", "nu = 0.7"),
    )
    for given, expected in zip(
        wrong, ("not a scene file", "x", "did you mean", "Poisson"), strict=True
    ):
        reply = ask(tab, "begin", text=given)
        assert expected in reply["refused"] and "Traceback" not in reply["refused"]
        assert tab.solution is last
    tab = session(contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Isolated(), load=1e9))
    assert "border" in ask(tab, "frame")["refused"] and tab.solution is None


def test_a_fault_of_the_program_is_reported_as_one(monkeypatch: pytest.MonkeyPatch) -> None:
    tab = session(WAVE)

    def broken(*_: object) -> None:
        raise ZeroDivisionError("division\nby zero")

    monkeypatch.setattr("contact.explorer.session.drawn", broken)
    assert ask(tab, "frame")["refused"] == (
        "an error of the program, not of the scene (ZeroDivisionError: division by zero)."
    )


def test_a_reply_is_read_back_as_it_was() -> None:
    numbers = np.array([[1.5, np.nan], [2.0, -np.inf]])
    read = bytes(Reply({"title": "µ"}, {"fields": numbers}))
    length = int.from_bytes(read[:8], "little")
    header = json.loads(read[8 : 8 + length])
    assert length % 8 == 0 and header == {"title": "µ", "arrays": {"fields": [2, 2]}}
    assert np.array_equal(np.frombuffer(read[8 + length :]).reshape(2, 2), numbers, equal_nan=True)


def test_the_page_s_files_name_no_other_address() -> None:
    files = [file for file in server._FILES.iterdir() if file.suffix in server._TYPES]
    text = {file.name: file.read_text(encoding="utf-8") for file in files}
    assert not [name for name, said in text.items() if re.search(r"https?:|//[a-z]+\.", said)]
    named = {
        name
        for said in text.values()
        for name in re.findall(r'(?:src|href|from) ?=? ?"\.?/?([\w.]+)"', said)
    }
    assert named <= set(text) and "main.js" in named


@pytest.fixture
def wave_page() -> Iterator[server.Page]:
    page = contact.explore(WAVE)
    yield page
    page.close()


def status(request: Request) -> int:
    try:
        with urlopen(request, timeout=30) as answer:
            return int(answer.status)
    except HTTPError as refused:
        return refused.code


def test_only_the_page_itself_may_speak_to_its_server(wave_page: server.Page) -> None:
    address, body = wave_page.address, b'{"ask": "frame"}'
    own = {"Origin": address.rstrip("/")}
    assert address.startswith(f"http://{ADDRESS}:") and address in wave_page._repr_html_()
    assert status(Request(address)) == 200
    assert status(Request(address + "ask", data=body, headers=own)) == 200
    assert status(Request(address + "ask", data=b"{", headers=own)) == 400
    for other in ("http://elsewhere.example", "null"):
        assert status(Request(address + "ask", data=body, headers={"Origin": other})) == 403
    assert status(Request(address + "ask", data=body)) == 403
    assert status(Request(address, headers={"Host": "elsewhere.example"})) == 403
    assert status(Request(address + "..%2fserver.py")) == 404
    assert status(Request(address + "../server.py")) == 404


def test_a_port_that_is_taken_is_refused_by_name(wave_page: server.Page) -> None:
    taken = int(wave_page.address.rsplit(":", 1)[1].strip("/"))
    with pytest.raises(contact.SceneError, match="port"):
        contact.explore(WAVE, port=taken)


@dataclass
class Served:
    page: Page
    address: str


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """The page of a wave, as the command serves it, in a browser."""
    if CHROMIUM is None:
        pytest.skip(MISSING)
    file = tmp_path_factory.mktemp("scene") / "wave.toml"
    file.write_text(to_toml(WAVE), encoding="utf-8")
    command = [sys.executable, "-m", "contact", "explore", "--no-show", str(file)]
    with subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True
    ) as process:
        try:
            address = process.stdout.readline().split()[0]
            with browser() as page:
                page.open(address)
                at_rest(page)
                yield Served(page, address)
        finally:
            process.terminate()


TEXT = "document.querySelector('textarea').value"
NUMBERS = "[...document.querySelectorAll('dl > div')].map(one => [...one.children].map(part => part.innerText))"
SIZES = (390, 768, 1280)


def at_rest(page: Page) -> str:
    """The text of the scene file, once the page shows the full solution of its scene."""
    return page.until(lambda: page.run(f"document.body?.dataset.rest === 'yes' && {TEXT}"), 120)


def shown(page: Page) -> dict[str, str]:
    return dict(page.run(NUMBERS))


def click(page: Page, selector: str) -> None:
    page.run(f"document.querySelector({selector!r}).click()")


def preset(page: Page, name: str) -> None:
    buttons = "[...document.querySelectorAll('nav button')]"
    page.run(f"{buttons}.find(one => one.innerText === {name!r}).click()")
    page.until(
        lambda: page.run(f"{buttons}.find(one => one.ariaPressed === 'true').innerText") == name
    )


@pytest.mark.slow
@pytest.mark.parametrize("width", SIZES)
@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_fits_and_says_what_a_solve_says(
    served: Served, name: str, width: int
) -> None:
    page = served.page
    page.resize(width)
    preset(page, name)
    solution = contact.solve(scene_from_tables(tomllib.loads(at_rest(page))))
    now = shown(page)
    assert page.run("document.querySelector('#refused').hidden")
    assert float(now["stated error, at most"]) <= 1e-8 and now["certificate"] == "holds"
    assert agrees(now["load"], solution.load, "N/m")
    assert agrees(now["largest pressure"], solution.max_pressure, "Pa")
    assert agrees(now["width in contact"], float(np.sum(solution.zone_widths)), "m")
    if solution.approach is not None:
        assert agrees(now["approach"], solution.approach, "m")
    click(page, 'input[name="below"][value="mises"]')
    at_rest(page)
    if name == "layer":
        assert "largest von Mises" not in shown(page)
    elif np.isfinite(solution.max_pressure) and name != "JKR":
        given = tomllib.loads(PRESETS[name].text)["material"]
        report = contact.extras.require("contact.solution.stress_report")
        largest = report.stress_report(solution, given["nu1"]).mises
        assert shown(page)["largest von Mises"] == quantity(largest.stress, "Pa")
    # No element is wider than the window.
    assert page.run("document.documentElement.scrollWidth") <= width
    wide = "[...document.querySelectorAll('main *')].map(one => one.getBoundingClientRect().right)"
    assert page.run(f"Math.max(...{wide})") <= width
    click(page, 'input[name="below"][value="none"]')
    at_rest(page)
    assert served.page.faults == []


@pytest.mark.slow
@pytest.mark.parametrize("width", SIZES)
def test_dragging_the_load_shows_the_numbers_of_that_load(served: Served, width: int) -> None:
    page = served.page
    page.resize(width)
    preset(page, "given scene")
    before = at_rest(page)
    page.drag("document.querySelector('input[type=range]')", 0.1 * width)
    page.until(lambda: at_rest(page) != before)
    found = contact.solve(scene_from_tables(tomllib.loads(at_rest(page))))
    now = shown(page)
    assert now["mean pressure"] == quantity(found.mean_pressure, "Pa")
    assert agrees(now["contact fraction"], found.contact_fraction, "")
    assert agrees(now["largest pressure"], found.max_pressure, "Pa")
    label = "document.querySelector('#sliders output').innerText"
    assert page.run(label) == quantity(found.mean_pressure, "Pa")


@pytest.mark.slow
def test_a_frame_is_painted_for_every_few_moves(served: Served) -> None:
    page, painted = served.page, "document.querySelector('#contact').frames"
    page.resize(1280)
    preset(page, "wave")
    at_rest(page)
    before = page.run(painted)
    page.drag("document.querySelector('input[type=range]')", -40, steps=40)
    at_rest(page)
    assert 5 <= page.run(painted) - before <= 60


@pytest.mark.slow
def test_dragging_over_a_stretch_zooms_into_it(served: Served) -> None:
    """Dragging over the picture shows that stretch of x; a double click shows all of it again."""
    page, canvas = served.page, "document.querySelector('#contact')"
    page.resize(1280)
    preset(page, "wave")
    at_rest(page)
    across = f"(one => one.high - one.low)({canvas}.across)"
    whole = page.run(across)
    page.drag(canvas, 100)
    page.until(lambda: page.run(across) < 0.5 * whole)
    width = page.run(f"{canvas}.clientWidth")
    assert page.run(across) == pytest.approx(whole * 100 / (width - 76), rel=0.03)
    page.click(canvas, times=2)
    page.until(lambda: page.run(across) == whole)


@pytest.mark.slow
def test_a_button_enlarges_the_largest_pressure_of_a_trace(served: Served) -> None:
    """The first click shows six times the width of the zone; the second one shows all."""
    page, canvas = served.page, "document.querySelector('#contact')"
    page.resize(768)
    preset(page, "wave")
    at_rest(page)
    assert page.run("document.querySelector('#close').hidden")
    rough = "\n".join(PRESETS["rough"].text.replace("1.2e8", "1e6").split("\n"))
    page.run(f"document.querySelector('textarea').value = {json.dumps(rough)}")
    click(page, "#solve")
    (zone,) = contact.solve(scene_from_tables(tomllib.loads(at_rest(page)))).zones
    click(page, "#close")
    across = page.until(lambda: (now := page.run(f"{canvas}.across"))["high"] < 450 and now)
    assert across["low"] < 1e6 * zone[0] < 1e6 * zone[1] < across["high"]
    assert across["high"] - across["low"] == pytest.approx(6e6 * np.ptp(zone), rel=1e-6)
    click(page, "#close")
    page.until(lambda: page.run(f"{canvas}.across.high") > 450)


@pytest.mark.slow
def test_a_bad_scene_is_a_message_on_the_page(served: Served) -> None:
    page, refused = served.page, "document.querySelector('#refused')"
    page.resize(1280)
    preset(page, "wave")
    at_rest(page)
    area = "document.querySelector('textarea')"
    page.run(f"({area}.focus(), {area}.select())")
    page.type('[profile]\nshape = "sinusiod"')
    click(page, "#solve")
    page.until(lambda: not page.run(f"{refused}.hidden"))
    message = page.run(f"{refused}.innerText")
    assert "missing" in message and "the last scene that was solved" in message
    assert "Traceback" not in page.run("document.documentElement.innerHTML")
    # The page still works.
    page.drag("document.querySelectorAll('input[type=range]')[1]", 20)
    page.until(lambda: page.run(f"{refused}.hidden"))
    at_rest(page)
    assert shown(page)["certificate"] == "holds"


@pytest.mark.slow
def test_all_that_the_page_loads_comes_from_this_machine(served: Served) -> None:
    assert served.address.startswith(f"http://{ADDRESS}:")
    asked = [one for one in served.page.requests if not one.startswith(("data:", "blob:"))]
    assert len(asked) > 5
    assert [one for one in asked if not one.startswith(served.address)] == []
    assert served.page.faults == []
