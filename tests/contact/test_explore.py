"""`contact explore`: what can be turned, what a frame says, and the page in a real browser."""

from __future__ import annotations

import asyncio
import math
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from tornado.httpclient import HTTPClientError, HTTPRequest
from tornado.websocket import websocket_connect

import contact
from contact.explorer import page
from contact.explorer.explore import ADDRESS
from contact.explorer.frame import drawn
from contact.explorer.handles import handles, turned
from contact.explorer.page import Explorer
from contact.model.scene_file import scene_from_tables, to_toml
from contact.model.units import quantity
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
def test_handles_that_stand_where_they_were_leave_the_scene_as_it_is(name: str) -> None:
    scene = SCENES[name]
    known = handles(scene)
    assert known[0].name == scene.control[0]
    assert len({handle.name for handle in known}) == len(known)
    assert turned(scene, {handle.name: handle.value for handle in known}, known) is scene
    assert all(handle.low <= handle.value <= handle.high or handle.whole for handle in known)


@pytest.mark.parametrize("name", ["wave", "series", "trace"])
def test_amplitude_and_length_of_a_shape_scale_it_however_it_is_given(name: str) -> None:
    scene = SCENES[name]
    known = {handle.name: handle for handle in handles(scene)}
    length = known["length" if name == "trace" else "period"]
    moved = turned(
        scene,
        {"amplitude": 3 * known["amplitude"].value, length.name: 2 * length.value},
        tuple(known.values()),
    ).profile
    x = np.linspace(0.0, 1e-4, 23)
    away = moved.height(2 * x) - 3 * scene.profile.height(x)
    assert np.ptp(away) < 1e-12 * known["amplitude"].value * 3


def test_samples_of_a_shape_are_points_on_it() -> None:
    sampled = turned(WAVE, {"samples": 16}, handles(WAVE)).profile
    assert len(sampled.x) == 16
    assert np.ptp(sampled.height(sampled.x) - WAVE.profile.height(sampled.x)) < 1e-20
    assert np.ptp(sampled.height(sampled.x + 3e-6) - WAVE.profile.height(sampled.x + 3e-6)) > 1e-12


def test_a_slider_that_moves_shows_the_solution_of_the_text_beside_it() -> None:
    page = Explorer(WAVE, 1e-8)
    page.sliders.objects[0].value -= 0.5
    scene = scene_from_tables(tomllib.loads(page.text.value))
    assert scene.mean_pressure == pytest.approx(1.7e9 / math.sqrt(10), rel=1e-3)
    solution = contact.solve(scene)
    assert np.array(page.frame.solution.zones) == pytest.approx(solution.zones, rel=1e-8)
    assert ["in contact", f"{solution.contact_fraction * 100:.6g} %"] in page.pictures.frame[
        "numbers"
    ]
    assert page.pictures.refused == ""
    before = page.pictures.curve
    assert len(before["points"][1]) > 20  # the load curve, up to full contact
    page.sliders.objects[0].value += 0.2
    assert page.pictures.curve == before
    page.sliders.objects[1].value += 0.2
    assert page.pictures.curve != before


@pytest.mark.parametrize("name", SCENES)
def test_a_frame_shows_the_fields_of_its_solution(name: str) -> None:
    found = drawn(contact.solve(SCENES[name]), 0.0)
    x, body, surface, touching, pressure = found.fields
    assert (np.diff(x) >= 0).all() and np.isfinite([x, body, surface, pressure]).all()
    # Bodies do not enter each other; they are one line just where they touch, and push there.
    room = 1e-6 * (max(body.max(), surface.max()) - min(body.min(), surface.min()))
    assert (body - surface > -room).all()
    inside = np.any((x >= found.zones[:, :1]) & (x <= found.zones[:, 1:]), axis=0)
    assert (np.isfinite(touching) == inside).all() and (np.abs(body - surface)[inside] < room).all()
    assert (pressure[~inside] == 0.0).all() and pressure[inside].max() > 0.0
    assert [name.partition(" ")[0] for name in found.names] == ["x", "height", "pressure"]


@pytest.fixture
def awaited(monkeypatch: pytest.MonkeyPatch) -> list[Callable[[], None]]:
    """What a served page has put off, in order; a hand rests as soon as there is nothing else to
    do.
    """
    later: list[Callable[[], None]] = []
    monkeypatch.setattr(Explorer, "_is_served", True)
    monkeypatch.setattr(Explorer, "_soon", lambda self, do, after=0: later.append(do))
    return later


def test_while_a_hand_moves_frames_are_light_and_at_rest_all_is_there(
    awaited: list[Callable[[], None]],
) -> None:
    shown = Explorer(WAVE, 1e-8)
    text, light = shown.text.value, points(shown)
    for _ in range(5):
        shown.sliders.objects[0].value -= 0.1
    # Of five moves one frame is due, and one thing to do when the hand rests.
    assert len(awaited) == 2
    awaited.pop()()
    assert shown.frame.solution.mean_pressure == pytest.approx(1.7e9 / math.sqrt(10), rel=1e-3)
    assert points(shown) <= 1.5 * light and shown.text.value == text
    assert len(awaited) == 1
    shown._rest_at = 0.0
    awaited.pop()()
    assert points(shown) > 1.5 * light
    assert (
        scene_from_tables(tomllib.loads(shown.text.value)).mean_pressure
        == shown.frame.solution.mean_pressure
    )
    # The load curve, a point at a time.
    while awaited:
        awaited.pop()()
    assert len(shown.pictures.curve["points"][1]) > 20


def test_a_frame_under_a_moving_hand_is_one_change_of_one_thing(
    awaited: list[Callable[[], None]],
) -> None:
    shown, changes = Explorer(WAVE, 1e-8), []
    shown._rest_at = 0.0
    while awaited:  # until the curve stands
        awaited.pop()()
    shown.pictures.param.watch(
        lambda event: changes.append(event.name), ["frame", "curve", "refused"]
    )
    for widget in (shown.text, shown.draw, shown.branch, *shown.sliders.objects):
        widget.param.watch(lambda event: changes.append(event.name), list(widget.param))
    for count in range(1, 4):
        shown.sliders.objects[0].value -= 0.1
        changes.clear()
        next(do for do in awaited if do.__name__ == "_show")()
        awaited[:] = [do for do in awaited if do.__name__ != "_show"]
        assert changes == ["frame"], count


def test_a_slider_waits_for_nothing_before_it_tells_its_value() -> None:
    # The name is Panel's: held, so that another version of it is noticed.
    assert type(Explorer(WAVE, 1e-8).sliders.objects[0])._debounce > 0
    assert {slider._debounce for slider in Explorer(WAVE, 1e-8).sliders.objects} == {0}


def points(shown: Explorer) -> int:
    """At how many places the fields are drawn."""
    return shown.pictures.frame["fields"].shape[1]


def test_a_scene_that_cannot_be_is_told_and_the_last_one_stays() -> None:
    page = Explorer(SCENES["layer"], 1e-8)
    last = page.frame
    wrong = (
        "[profile",
        "x = 1",
        page.text.value.replace('"sinusoid"', '"sinusiod"'),
        page.text.value.replace("nu = 0.3", "nu = 0.7"),
    )
    for text, said in zip(wrong, ("not a scene file", "x", "did you mean", "Poisson"), strict=True):
        page.text.value = text
        page._read()
        assert said in page.pictures.refused and "Traceback" not in page.pictures.refused
        assert page.frame is last
    isolated = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Isolated(), load=1.0)
    page = Explorer(isolated, 1e-8)
    page.text.value = page.text.value.replace("load = 1.0", "load = 1e9")
    page._read()
    assert "border" in page.pictures.refused and page.frame is None


def test_a_fault_of_the_program_is_told_as_one(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = Explorer(WAVE, 1e-8)

    def broken(*_: object) -> None:
        raise ZeroDivisionError("division\nby zero")

    monkeypatch.setattr(page, "solved", broken)
    shown.sliders.objects[0].value -= 0.5
    assert (
        "a fault of the program, not of the scene (ZeroDivisionError: division by zero)"
        in shown.pictures.refused
    )


def test_without_panel_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "panel", None)
    with pytest.raises(contact.MissingExtra, match=r"\[explore\]"):
        contact.explore(WAVE)


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
                page.until(
                    lambda: page.run(
                        "deep('dd').length > 5 && deep('textarea')[0].value.length > 20"
                    )
                )
                yield Served(page, address)
        finally:
            process.terminate()


def shown(page: Page) -> dict[str, str]:
    """The numbers that stand on the page: all of a frame, the last of which is its time."""
    rows = "deep('dl > div').map(one => [one.children[0].innerText, one.children[1].innerText])"
    return page.until(lambda: now if "solved in" in (now := dict(page.run(rows))) else None)


def solved(text: str) -> contact.Solution:
    return contact.solve(scene_from_tables(tomllib.loads(text)))


def in_contact(page: Page) -> str:
    """As it is solved here from the text on the page."""
    fraction = solved(page.run("deep('textarea')[0].value")).contact_fraction
    return f"{100 * fraction:.6g} %"


@pytest.mark.slow
def test_a_hand_that_drags_the_load_reads_the_numbers_of_that_load(served: Served) -> None:
    page = served.page
    before, text = shown(page), page.run("deep('textarea')[0].value")
    assert float(before["stated error, at most"]) <= 1e-8
    assert before["in contact"] == in_contact(page)
    page.drag("deep('.noUi-handle')[0]", -60)
    # The text follows once the hand is at rest.
    page.until(
        lambda: (
            page.run("deep('textarea')[0].value") != text
            and shown(page)["in contact"] == in_contact(page)
        )
    )
    now, found = shown(page), solved(page.run("deep('textarea')[0].value"))
    assert found.mean_pressure < 1.2e9
    assert now["highest pressure"] == quantity(found.max_pressure, "Pa", 6)
    assert float(now["stated error, at most"]) <= 1e-8 and now["certificate"] == "holds"


@pytest.mark.slow
def test_what_the_server_sends_of_a_frame_is_one_message_and_is_painted_once(
    served: Served,
) -> None:
    page, painted, text = served.page, "deep('canvas')[0].frames", "deep('textarea')[0].value"
    before, was, heard = page.run(painted), page.run(text), len(page.told)
    page.drag("deep('.noUi-handle')[0]", -40, steps=40)
    page.until(lambda: page.run(text) != was)
    patches = sum('"PATCH-DOC"' in said for said in page.told[heard:])
    assert 2 <= page.run(painted) - before <= patches


@pytest.mark.slow
def test_a_stretch_that_is_dragged_over_fills_the_pictures(served: Served) -> None:
    page, across = served.page, "(one => one.high - one.low)(deep('canvas')[0].across)"
    whole = page.run(across)
    page.drag("deep('canvas')[0]", 100)  # the middle is within the second picture
    width = page.run("deep('canvas')[0].clientWidth")
    page.until(lambda: page.run(across) == pytest.approx(whole * 100 / (width - 94), rel=0.02))
    page.click("deep('canvas')[0]", times=2)
    page.until(lambda: page.run(across) == whole)


@pytest.mark.slow
def test_a_bad_scene_is_a_message_on_the_page(served: Served) -> None:
    page = served.page
    page.run("(deep('textarea')[0].focus(), deep('textarea')[0].select())")
    page.type('[profile]\nshape = "sinusiod"')
    page.run("deep('textarea')[0].blur()")
    page.click("deep('button').find(one => one.innerText == 'solve this text')")
    said = page.until(lambda: page.run("deep('p.refused')[0].innerText"))
    assert "missing" in said and "the last scene that was solved" in said
    assert "Traceback" not in page.run("document.documentElement.innerHTML")
    # And the page goes on.
    page.drag("deep('.noUi-handle')[1]", 20)
    page.until(lambda: page.run("deep('p.refused')[0].hidden"))
    assert shown(page)["certificate"] == "holds"


@pytest.mark.slow
def test_all_that_the_page_loads_comes_from_this_machine(served: Served) -> None:
    assert served.address.startswith(f"http://{ADDRESS}:")
    own = served.address.partition("//")[2]
    asked = [
        address for address in served.page.requests if not address.startswith(("data:", "blob:"))
    ]
    assert len(asked) > 5
    assert [address for address in asked if address.partition("//")[2][: len(own)] != own] == []
    assert served.page.faults == []


async def _answer(address: str, origin: str) -> int:
    """The status that a page of that origin is answered with when it opens a socket."""
    request = HTTPRequest(address.replace("http", "ws") + "ws", headers={"Origin": origin})
    try:
        (await websocket_connect(request)).close()
    except HTTPClientError as refused:
        return refused.code
    return 101


@pytest.mark.slow
def test_only_the_page_itself_may_speak_to_its_server(served: Served) -> None:
    assert asyncio.run(_answer(served.address, served.address.rstrip("/"))) == 101
    assert asyncio.run(_answer(served.address, "http://elsewhere.example")) == 403
