"""Two rough bodies. Their gap is the sum of their heights, whichever one is called the counter
body, and whether the counter body is shifted or mirrored.
"""

from __future__ import annotations

import json
import pickle
import tomllib
from dataclasses import dataclass

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

import contact
from contact import (
    Combined,
    Flat,
    Fourier,
    Isolated,
    Localized,
    Parabola,
    Periodic,
    Sampled,
    Scene,
    SceneError,
    Sinusoid,
    Wedge,
)
from contact.commands import cli
from contact.explorer.handles import handles, with_values
from contact.formulation.conjugate import Conjugate
from contact.model.scene_file import scene_from_tables, to_toml
from contact.solution.sampling import surfaces
from contact.testing import check_profile

E = 1e11
L = 1e-3
_random = np.random.default_rng(11)
KNOTS = np.linspace(0.0, L, 49)
HEIGHTS = 1e-6 * np.convolve(_random.standard_normal(48), [0.25, 0.5, 0.25], "same")
TRACE = Sampled(KNOTS, np.append(HEIGHTS, HEIGHTS[0]), period=L)
PIECE = Sampled(np.sort(_random.uniform(0.0, L, 60)), 1e-7 * _random.standard_normal(60))


def solved(profile: contact.Profile, **given: float) -> contact.Solution:
    model = Isolated() if profile.period is None else Periodic()
    return contact.solve(
        Scene(
            profile,
            E,
            model,
            **(given or ({"load": 1e3} if profile.period is None else {"contact_fraction": 0.4})),
        )
    )


@settings(deadline=None, max_examples=12)
@given(st.floats(0.1, 10.0), st.floats(-3.0, 3.0), st.floats(0.1, 0.9), st.booleans())
def test_two_waves_of_one_period_are_one_wave(
    ratio: float, turns: float, fraction: float, mirrored: bool
) -> None:
    pair = Combined(Sinusoid(1e-6, L), Sinusoid(1e-6 * ratio, L), turns * L, mirrored)
    wave = 1 + ratio * np.exp(-2j * np.pi * turns)
    if abs(wave) < 0.05:
        return
    one = Fourier(L, [-1e-6 * wave.real], [1e-6 * wave.imag])
    x = np.linspace(-1.3 * L, 1.7 * L, 97)
    size = 1e-6 * (1 + ratio)
    assert np.ptp(pair.height(x) - one.height(x)) <= 1e-12 * size
    for name in ("slope", "slope_conjugate"):
        assert getattr(pair, name)(x) == pytest.approx(
            getattr(one, name)(x), abs=1e-12 * 2 * np.pi / L * size
        )
    # Westergaard: pbar = pi E* Delta/L sin^2(pi fraction/2), where Delta is the amplitude of the
    # sum of the two waves.
    exact = np.pi * E * 1e-6 * abs(wave) / L * np.sin(0.5 * np.pi * fraction) ** 2
    assert solved(pair, contact_fraction=fraction).mean_pressure == pytest.approx(exact, rel=1e-9)
    assert not solved(pair, contact_fraction=fraction).mean_pressure == pytest.approx(
        exact * (1 + 1e-6), rel=1e-9
    )


@pytest.mark.parametrize(
    "counter",
    [pytest.param(Wedge(0.01, L / 4), marks=pytest.mark.slow), TRACE],
    ids=lambda p: p.name,
)
@pytest.mark.parametrize("mirrored", [False, True])
def test_whichever_is_called_the_counter_body_the_contact_is_the_same(
    counter: contact.Profile, mirrored: bool
) -> None:
    shift = 1.3e-4
    back = shift if mirrored else -shift
    one, other = (
        solved(Combined(TRACE, counter, shift, mirrored)),
        solved(Combined(counter, TRACE, back, mirrored)),
    )
    assert other.load == pytest.approx(one.load, rel=1e-8)
    # Positions of the second pair are measured from the counter body of the first pair. They
    # increase in the opposite direction if this counter body is mirrored.
    there = shift - other.zones[:, ::-1] if mirrored else shift + other.zones
    middle, width = there.mean(axis=1) % L, np.diff(there).ravel()
    order = np.argsort(middle)
    expected = np.sort(one.zones.mean(axis=1) % L)
    assert middle[order] == pytest.approx(expected, abs=1e-9 * L)
    assert width[order] == pytest.approx(
        one.zone_widths[np.argsort(one.zones.mean(axis=1) % L)], abs=1e-9 * L
    )


def test_a_shift_by_a_period_of_the_counter_body_changes_nothing() -> None:
    one = solved(Combined(TRACE, Wedge(0.01, L / 4), 1e-4))
    for turns in (-3, 1, 8):
        assert solved(
            Combined(TRACE, Wedge(0.01, L / 4), 1e-4 + turns * L / 4)
        ).zones == pytest.approx(one.zones, abs=1e-10 * L)


def test_two_traces_of_the_same_positions_are_the_trace_of_their_summed_heights() -> None:
    heights = 1e-7 * _random.standard_normal(60)
    pair, one = (
        Combined(PIECE, Sampled(PIECE.x, heights)),
        Sampled(PIECE.x, PIECE.heights + heights),
    )
    x = np.linspace(*one.extent, 211)
    assert np.ptp(pair.height(x) - one.height(x)) <= 1e-13 * np.ptp(one.height(x))
    assert pair.extent == one.extent and pair.jumps == pytest.approx(
        one.jumps, rel=1e-9, abs=1e-12 * np.abs(one.jumps).max()
    )
    assert solved(pair).zones == pytest.approx(solved(one).zones, abs=1e-10 * L)
    assert np.ptp(
        Combined(PIECE, Sampled(PIECE.x, -heights)).height(x) - one.height(x)
    ) > 1e-3 * np.ptp(one.height(x))


@pytest.mark.parametrize("turns", (-20, -1, 1, 5))
def test_corners_face_each_other_however_many_periods_the_counter_body_is_shifted_by(
    turns: int,
) -> None:
    rows = contact.Flat(0.84, 1.0), contact.Flat(0.17, 1.0)
    assert contact.Combined(*rows, shift=0.265 + turns).support == pytest.approx(
        (0.18, 0.35), abs=1e-13
    )
    with pytest.raises(contact.SceneError, match="2 intervals"):
        contact.Combined(
            contact.Flat(0.29, 1.0), contact.Flat(1.398, 2.0), shift=-0.245 + 2.0 * turns
        )


@pytest.mark.parametrize("shift", [0.0, 0.25 * L, 30 * L])
def test_a_trace_on_a_flat_wider_than_it_is_the_trace(shift: float) -> None:
    trace = Sampled(PIECE.x + shift, PIECE.heights)
    pair = Combined(trace, Flat(3 * L), shift)
    assert pair.support is None and pair.extent == trace.extent
    assert solved(pair).zones == pytest.approx(solved(trace).zones, abs=1e-10 * (L + shift))


def test_a_flat_on_a_wave_is_a_punch_that_ends_there() -> None:
    pair = Combined(Flat(0.4 * L, L), Sinusoid(1e-6, L), 0.1 * L)
    assert pair.support == pytest.approx((-0.2 * L, 0.2 * L))
    swapped = Combined(Sinusoid(1e-6, L), Flat(0.4 * L, L), -0.1 * L)
    assert swapped.support == pytest.approx((-0.3 * L, 0.1 * L))
    for model in (Periodic(), Localized("self-consistent")):
        one, other = (contact.solve(Scene(p, E, model, load=1e5)) for p in (pair, swapped))
        assert other.zones + 0.1 * L == pytest.approx(one.zones, abs=1e-9 * L)


def test_mirroring_a_reversed_trace_restores_it() -> None:
    back = Sampled(-TRACE.x[::-1], TRACE.heights[::-1], period=L)
    one, other = Combined(PIECE, TRACE, 1e-4), Combined(PIECE, back, 1e-4, mirrored=True)
    x = np.linspace(*one.extent, 211)
    for name in ("height", "slope"):
        assert getattr(other, name)(x) == pytest.approx(
            getattr(one, name)(x), abs=1e-12 * np.abs(getattr(one, name)(x)).max()
        )
    assert other.jumps == pytest.approx(one.jumps, rel=1e-9)
    assert other.jumps[:, 2] != pytest.approx(-one.jumps[:, 2], rel=1e-9)


def test_kinks_and_jumps_of_both_bodies_at_one_place_are_added() -> None:
    wedge = Wedge(0.02, L)
    assert Combined(wedge, wedge).kinks == pytest.approx(np.array([[-0.5 * L, -0.08], [0.0, 0.08]]))
    # The tip of one wedge lies on the valley of the other. Their kinks cancel within round-off.
    assert len(Combined(wedge, wedge, 0.5 * L).kinks) == 0
    assert len(Combined(wedge, wedge, 0.3 * L).kinks) == 4
    assert (
        len(Combined(TRACE, TRACE, L / 48).jumps) == 48
        and len(Combined(TRACE, TRACE, L / 96).jumps) == 96
    )


def test_an_asperity_on_a_trace_has_a_finite_extent_and_on_a_wave_has_none() -> None:
    pair = Combined(Parabola(1.0), TRACE, 1e-4)
    assert pair.period is None and pair.extent is not None
    assert check_profile(
        Combined(
            Parabola(1.0), Sampled(KNOTS[:9] / 8, np.append(HEIGHTS[:8], HEIGHTS[0]), period=L / 48)
        )
    ).ok
    assert contact.solve(Scene(pair, E, Isolated(), load=3e3)).certificate.holds
    assert Combined(Parabola(1.0), Sinusoid(1e-6, L)).extent is None


def test_a_pair_has_symmetry_and_summits_if_both_bodies_have_them_at_one_place() -> None:
    assert Combined(Wedge(0.1), Parabola(1.0)).summits == pytest.approx([0.0])
    assert Combined(Sinusoid(1e-6, L), Sinusoid(1e-6, L / 2), 0.25 * L).symmetric
    for pair in (
        Combined(Wedge(0.1), Parabola(1.0), 1e-6),
        Combined(Sinusoid(1e-6, L), Sinusoid(1e-6, L / 2), 0.2 * L),
    ):
        assert not pair.symmetric and pair.summits is None
    # One zone of half width a under a wedge plus a parabola: P = E* (slope a + pi a^2/(4 R)). The
    # loads add up because the equation is linear in the profile.
    solution = contact.solve(
        Scene(Combined(Wedge(0.01), Parabola(0.1)), E, Isolated(), half_width=2e-4)
    )
    assert solution.load == pytest.approx(E * (0.01 * 2e-4 + np.pi * 4e-8 / 0.4), rel=1e-12)


@dataclass(frozen=True)
class Alone(contact.Profile):
    """The same shape as a pair, given as one profile without separate bodies."""

    pair: Combined

    height, slope = (lambda self, x: self.pair.height(x)), (lambda self, x: self.pair.slope(x))
    period, kinks, jumps = (
        property(lambda self, name=name: getattr(self.pair, name))
        for name in ("period", "kinks", "jumps")
    )


@pytest.mark.parametrize("mirrored", [False, True])
def test_the_transform_of_the_slope_of_a_pair_is_that_of_the_summed_profile(mirrored: bool) -> None:
    pair = Combined(
        Sampled(KNOTS / 2, TRACE.heights[[*range(48), 0]], period=L / 2),
        Wedge(0.01, L / 3),
        1e-4,
        mirrored,
    )
    x = np.linspace(0.0, L, 101) + 1e-6
    one, other = Conjugate(pair)(x), Conjugate(Alone(pair))(x)
    assert one == pytest.approx(other, abs=1e-10 * np.abs(other).max())
    assert one == pytest.approx(pair.slope_conjugate(x), abs=1e-10 * np.abs(other).max())


REFUSED = {
    "no common period": (
        lambda: Combined(Sinusoid(1e-6, 1e-4), Sinusoid(1e-6, 3.3333e-5)),
        "counter.period",
        "3.3333333333333335e-05",
    ),
    "too many cells": (
        lambda: Combined(Sinusoid(1e-6, 1.0), Sinusoid(1e-6, 3e-5)),
        "counter.period",
        "fraction of whole numbers",
    ),
    "apart": (lambda: Combined(PIECE, PIECE, 2 * L), "shift", "parts of the bodies overlap"),
    "half a corner": (lambda: Combined(PIECE, Flat(L), L), "shift", "or lies between them"),
    "punches in a row": (
        lambda: Combined(Flat(L / 2, L), Sinusoid(1e-6, 3 * L)),
        "counter",
        "3 intervals",
    ),
    "punches without end": (
        lambda: Combined(Parabola(1.0), Flat(L / 2, L)),
        "counter",
        "one common interval",
    ),
    "flats apart": (lambda: Combined(Flat(L), Flat(L), 2 * L), "counter", "never face each other"),
    "a number": (lambda: Combined(PIECE, 3), "counter", "one body"),
    "a pair": (lambda: Combined(Combined(TRACE, TRACE), TRACE), "profile", "one body"),
    "a shift that is none": (lambda: Combined(TRACE, TRACE, np.nan), "shift", "finite"),
    "neither turned nor not": (
        lambda: Combined(TRACE, TRACE, 0.0, "yes"),
        "mirrored",
        "True or False",
    ),
    "no period": (
        lambda: Scene(Combined(TRACE, PIECE), E, Periodic(), load=1.0),
        "interaction",
        "counter has no period",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_bodies_that_make_no_pair_are_refused_by_name(name: str) -> None:
    make, field, told = REFUSED[name]
    with pytest.raises(SceneError, match=told) as caught:
        make()
    assert caught.value.field == field


def test_a_user_s_counter_body_is_checked_as_a_profile_is() -> None:
    @dataclass(frozen=True)
    class Odd(contact.Profile):
        def height(self, x):
            return np.zeros(3)

    with pytest.raises(SceneError, match=r"profile\.height"):
        Scene(Combined(PIECE, Odd()), E, Isolated(), load=1.0)


FILE = """
[profile]
shape = "sinusoid"
amplitude = 1e-6
period = 1e-4

[counter]
shape = "wedge"
slope = 0.02
period = 2e-4
shift = 1e-5
mirrored = true

[material]
E_star = 1e11

[interaction]
model = "periodic"

[control]
mean_pressure = 1e8
"""


def test_a_scene_file_holds_both_bodies_and_is_written_as_it_was_read(tmp_path) -> None:
    scene = scene_from_tables(tomllib.loads(FILE))
    assert scene.profile == Combined(Sinusoid(1e-6, 1e-4), Wedge(0.02, 2e-4), 1e-5, True)
    assert (
        scene_from_tables(tomllib.loads(to_toml(scene)))
        == scene
        == pickle.loads(pickle.dumps(scene))
    )
    file = tmp_path / "pair.toml"
    file.write_text(FILE, encoding="utf-8")
    said = CliRunner().invoke(cli.main, ["solve", str(file)])
    assert (
        said.exit_code == 0
        and "period 200 µm: 2 of profile, 1 of counter" in said.output
        and "slope 0.02," in said.output
    )
    tables = json.loads(CliRunner().invoke(cli.main, ["solve", str(file), "--json"]).output)[
        "scene"
    ]
    assert (
        tables["counter"] == tomllib.loads(FILE)["counter"]
        and tables["profile"] == tomllib.loads(FILE)["profile"]
    )


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("slope = 0.02", "slop = 0.02", r"\[counter\] parameter of profile 'wedge' = 'slop'"),
        ('"wedge"', '"wegde"', r"\[counter\] shape = 'wegde'"),
        ("shift = 1e-5", 'shift = "1e-5"', r"\[counter\] shift"),
        ("period = 2e-4", "period = 2.1234567e-5", r"\[counter\] counter.period"),
        ("period = 2e-4", "", "counter has no period"),
        ("[counter]", "[conter]", "did you mean 'counter'"),
    ],
)  # fmt: skip
def test_a_fault_in_the_counter_table_is_reported_with_its_table_and_key(
    old: str, new: str, told: str
) -> None:
    with pytest.raises(SceneError, match=told):
        scene_from_tables(tomllib.loads(FILE.replace(old, new)))


def test_a_sweep_over_the_shift_of_the_counter_body() -> None:
    pytest.importorskip("xarray")
    pair = Scene(
        Combined(Sinusoid(2e-6, L), Sinusoid(1e-6, L)), E, Periodic(), contact_fraction=0.5
    )
    shifts = L * np.arange(5) / 8
    table = contact.sweep(pair, {"counter.shift": shifts}, workers=1)
    assert table.counter_shift.attrs["units"] == "m"
    exact = np.pi * E / L * np.abs(2e-6 + 1e-6 * np.exp(-2j * np.pi * shifts / L)) * 0.5
    assert table["mean_pressure"].values == pytest.approx(exact, rel=1e-8)
    # Both periods change together. A change of only one would leave no common period.
    both = contact.sweep(pair, {"profile.period": [3e-4], "counter.period": [3e-4]}, workers=1)
    assert not both["failed"].any()


def test_each_surface_is_drawn_on_its_own_side() -> None:
    for pair in (
        Combined(TRACE, Sinusoid(1e-6, L / 2), 1e-4),
        Combined(Sinusoid(1e-6, L), Flat(0.4 * L, L), 1e-4),
    ):
        solution = solved(pair, load=1e5)
        x = np.linspace(pair.x0, pair.x0 + L, 301)
        surface, body = surfaces(solution, x)
        below = np.isfinite(surface)
        assert (body - surface)[below] == pytest.approx(solution.gap(x)[below], abs=1e-18)
        # The body is drawn undeformed. The face of the counter body is drawn deformed by the
        # displacement.
        assert np.ptp(body - pair.profile.height(x)) <= 1e-8 * np.ptp(pair.profile.height(x))
        face = -pair.counter.height(x[below] - 1e-4)
        assert np.ptp(surface[below] - (face - solution.displacement(x[below]))) <= 1e-18


def test_the_page_has_a_slider_for_each_body_and_for_the_shift() -> None:
    scene = scene_from_tables(tomllib.loads(FILE))
    known = handles(scene)
    assert [handle.name for handle in known] == [
        "mean_pressure",
        "amplitude",
        "counter slope",
        "shift",
        "E_star",
    ]
    moved = with_values(scene, {"counter slope": 0.03, "shift": 4e-5}, known).profile
    assert moved == Combined(Sinusoid(1e-6, 1e-4), Wedge(0.03, 2e-4), 4e-5, True)
