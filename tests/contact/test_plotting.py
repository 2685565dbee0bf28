"""Figures show the numbers of a solution in the labelled units, and change no global setting."""

from __future__ import annotations

import re
import subprocess
import sys

import numpy as np
import pytest

import contact
from contact.model.units import quantity, scaled
from contact.solution.stress_report import stress_report
from contact.sweeps.compare import NEIGHBOURS, compare
from tests.contact.stand_in import StandIn

matplotlib = pytest.importorskip("matplotlib")
colors = pytest.importorskip("matplotlib.colors")
plotting = pytest.importorskip("contact.solution.plotting")
comparing = pytest.importorskip("contact.sweeps.compare_plot")
stresses = pytest.importorskip("contact.solution.stress_plot")
drawing = pytest.importorskip("contact.solution.drawing")

L = 1e-4


def westergaard(half_width=0.2 * L, waves=1) -> StandIn:
    profile = contact.Fourier(L, cosine=[0.0] * (waves - 1) + [-1e-6])
    scene = contact.Scene(profile, E_star=1.1e11, interaction=contact.Periodic(), mean_pressure=1e7)
    return StandIn(scene, 1e-6, half_width / waves, waves)


def lines(axes) -> dict:
    return {line.get_label(): np.array(line.get_xydata()) for line in axes.get_lines()}


class TestPanels:
    def test_one_zone_has_a_panel_of_surfaces_above_one_of_pressure(self):
        top, bottom = plotting.plot(westergaard()).axes
        assert top.get_ylabel() == "height [µm]"
        assert bottom.get_ylabel() == "pressure [GPa]"
        assert bottom.get_xlabel() == "$x$ [µm]"

    def test_the_pressure_drawn_is_the_solutions_in_the_units_of_its_label(self):
        solution = westergaard()
        bottom = plotting.plot(solution).axes[1]
        x, drawn = bottom.get_lines()[0].get_xydata().T
        assert np.allclose(drawn, solution.pressure(x * 1e-6) * 1e-9, rtol=1e-6, atol=1e-4)
        assert drawn.max() == pytest.approx(solution.max_pressure * 1e-9, rel=1e-6)
        assert not np.allclose(
            drawn, 1.01 * solution.pressure(x * 1e-6) * 1e-9, rtol=1e-6, atol=1e-4
        )

    def test_profile_and_deformed_surface_are_a_gap_apart_and_meet_where_contact_is_drawn(self):
        solution = westergaard()
        drawn = lines(plotting.plot(solution).axes[0])
        x = drawn["profile"][:, 0] * 1e-6
        apart = (drawn["profile"] - drawn["deformed surface"])[:, 1] * 1e-6
        # `westergaard` computes the gap in closed form. Close to an end, this gap is a difference
        # of two terms that agree in all but the last digits.
        assert np.allclose(apart, solution.gap(x), rtol=0, atol=2e-14)
        touching = np.isfinite(drawn["contact"][:, 1])
        # Samples within round-off of an end may count as contact or as gap.
        clear = np.abs(np.abs(x) - 0.2 * L) > 1e-12 * L
        assert np.array_equal(touching[clear], np.abs(x[clear]) < 0.2 * L)

    def test_full_contact_is_drawn_as_contact_everywhere(self):
        figure = plotting.plot(westergaard(0.5 * L))
        assert np.isfinite(lines(figure.axes[0])["contact"]).all()

    @pytest.mark.parametrize("solution", [westergaard(waves=30), westergaard(half_width=0.01 * L)])
    def test_zones_too_many_or_too_narrow_have_a_second_column_around_the_peak(self, solution):
        axes = plotting.plot(solution).axes
        assert len(axes) == 4
        close = next(a for a in axes if a.get_title())
        lo, hi = (end * 1e-6 for end in close.get_xlim())
        width = solution.zone_widths[0]
        assert hi - lo == pytest.approx(6 * width, rel=1e-9)
        assert any(lo < middle < hi for middle in solution.zones.mean(axis=1))

    def test_the_pointer_to_the_second_column_does_not_hide_the_spike(self):
        solution = westergaard(half_width=0.001 * L)
        for whole in plotting.plot(solution).axes[::2]:
            pointers = [
                line
                for line in whole.get_lines()
                if len(line.get_xdata()) < 3 and line.get_label() == "_close-up"
            ]
            assert len(pointers) == 1 and list(pointers[0].get_ydata()) == [
                1.0
            ]  # on the frame, above what is drawn
            drawn = min(line.get_zorder() for line in whole.get_lines())
            shades = [
                patch
                for patch in whole.patches
                if patch.get_width() < 0.5 * np.diff(whole.get_xlim())[0]
            ]
            assert shades and all(shade.get_zorder() < drawn for shade in shades)

    def test_body_and_counter_face_are_named_on_their_own_side(self):
        solution = contact.solve(
            contact.Scene(contact.Flat(2e-5, 6e-5), 1.1e11, contact.Periodic(), mean_pressure=1e7)
        )
        top = plotting.plot(solution).axes[0]
        x, y = next(t.xy for t in top.texts if t.get_text() == "body")
        lo, hi = top.get_xlim()
        # The punch is a body only over its own width: |x| < 10 in the unit of the axis.
        assert abs(lo + x * (hi - lo)) < 10 and y > 0.5
        assert next(t.xy[1] for t in top.texts if t.get_text() == "counter-face") < 0.5


class TestScenes:
    @pytest.mark.parametrize(
        ("profile", "interaction", "control"),
        [
            (contact.Flat(2e-5), contact.Isolated(), {"load": 1e3}),
            (contact.Flat(2e-5, 6e-5), contact.Periodic(), {"mean_pressure": 1e7}),
            (contact.Wedge(0.02, L), contact.Periodic(), {"mean_pressure": 2e8}),
            (contact.Parabola(1e-2), contact.Isolated(), {"load": 1e5}),
            (
                contact.Biquadratic(1e-4, 2e-5, 6e-5),
                contact.Localized("self-consistent"),
                {"mean_pressure": 2e8},
            ),
            (contact.Sinusoid(1e-6, L), contact.Periodic(), {"mean_pressure": 4e9}),
        ],
    )
    def test_every_scene_is_drawn_and_saved_without_a_warning(
        self, tmp_path, recwarn, profile, interaction, control
    ):
        solution = contact.solve(contact.Scene(profile, 1.1e11, interaction, **control))
        figure = plotting.plot(solution)
        figure.savefig(tmp_path / "out.png", dpi=50)
        assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")
        # Libraries that matplotlib uses may cause deprecation warnings.
        assert all(
            issubclass(warning.category, (contact.ModelWarning, DeprecationWarning))
            for warning in recwarn
        )
        for axes in figure.axes:
            assert np.isfinite([*axes.get_xlim(), *axes.get_ylim()]).all()

    def test_an_infinite_peak_is_named_and_the_axis_stays_finite(self):
        solution = contact.solve(
            contact.Scene(contact.Flat(2e-5), 1.1e11, contact.Isolated(), load=1e3)
        )
        bottom = plotting.plot(solution).axes[1]
        assert any("infty" in text.get_text() for text in bottom.texts)
        assert bottom.get_ylim()[1] == pytest.approx(1.08 * 4 * 1e3 / 2e-5 * 1e-6, rel=1e-9)


@pytest.mark.parametrize(
    ("law", "said"),
    [(contact.JKR(0.01), r"-\infty"), (contact.Dugdale(0.01, 5e7), "tension 50 MPa")],
    ids=["JKR", "Dugdale"],
)
@pytest.mark.parametrize("load", [100.0, 0.0, -4.0])
def test_a_tension_far_above_the_peak_pressure_is_cut_off_and_named(law, said, load):
    scene = contact.Scene(contact.Parabola(1e-3), 1e9, contact.Isolated(), law=law, load=load)
    solution = contact.solve(scene)
    (bottom,) = (
        axes
        for axes in plotting.plot(solution).axes[:3]
        if axes.get_ylabel().startswith("pressure")
    )
    drawn = bottom.lines[0].get_ydata()
    low, high = bottom.get_ylim()
    assert low < 0 < high and np.min(drawn) < low and np.max(drawn) < high
    inside = solution.pressure_at(np.linspace(-0.9, 0.9, 99)) / prefix_factor(
        UNIT.search(bottom.get_ylabel())[1]
    )
    assert np.ptp(np.clip(inside, low, high)) > 0.3 * (high - low)
    assert any(said in text.get_text() for text in bottom.texts)


def scenes():
    """Scenes of each kind by name, with sizes from nanometres to metres."""
    wave, alone, row = contact.Sinusoid(1e-6, L), contact.Isolated(), contact.Periodic()
    rough = contact.Fourier(1e-3, cosine=[1e-6 / k for k in range(1, 60)])
    return {
        "hertz": contact.Scene(contact.Parabola(2e-8), 1.1e11, alone, load=1.0),
        "wheel": contact.Scene(contact.Parabola(0.46), 1.1e11, alone, load=1e6),
        "light": contact.Scene(wave, 1.1e11, row, mean_pressure=1e3),
        "rough": contact.Scene(rough, 1.1e11, row, mean_pressure=1e7),
        "punch": contact.Scene(contact.Flat(2e-5, 6e-5), 1.1e11, row, mean_pressure=1e7),
        "adhesive": contact.Scene(wave, 1e9, row, law=contact.JKR(0.01), mean_pressure=1e5),
        "cohesive": contact.Scene(
            wave, 1e9, row, law=contact.Dugdale(0.01, 5e6), mean_pressure=1e5
        ),
        "sliding": contact.Scene(
            wave, 1.1e11, row, law=contact.Sliding(0.3, 0.2, -1), mean_pressure=1e9
        ),
        "plastic": contact.Scene(wave, 1.1e11, row, law=contact.Plastic(3e9), mean_pressure=1.7e9),
        "layer": contact.Scene(
            wave, 1.1e11, row, substrate=contact.Layer(5e-6, 0.3), mean_pressure=1e9
        ),
    }


@pytest.fixture(scope="module", params=list(scenes()))
def drawn(request):
    """A solution of each scene, and its figure."""
    solution = contact.solve(scenes()[request.param], tol=1e-6)
    return solution, plotting.plot(solution)


UNIT = re.compile(r"\[([pnµmkMGT]?)(m|Pa)\]$")


class TestEveryFigure:
    def test_has_axes_with_a_quantity_and_a_unit(self, drawn):
        _, figure = drawn
        for top, bottom in zip(*np.split(np.array(figure.axes), 2), strict=True):
            assert top.get_ylabel().startswith("height [") and UNIT.search(top.get_ylabel())
            assert bottom.get_ylabel().startswith("pressure [")
            assert UNIT.search(bottom.get_ylabel())[2] == "Pa"
            assert UNIT.search(bottom.get_xlabel())[2] == "m"

    def test_has_one_unit_for_each_quantity(self, drawn):
        _, figure = drawn
        tops, bottoms = np.split(np.array(figure.axes), 2)
        for labels in (
            [axes.get_ylabel() for axes in tops],
            [axes.get_ylabel() for axes in bottoms],
            [UNIT.search(axes.get_xlabel())[0] for axes in bottoms],
        ):
            assert len(set(labels)) == 1

    def test_has_limits_that_contain_all_finite_pressures(self, drawn):
        solution, figure = drawn
        bottom = figure.axes[len(figure.axes) // 2]
        factor = 1.0 / prefix_factor(UNIT.search(bottom.get_ylabel())[1])
        low, high = bottom.get_ylim()
        pressure = solution.pressure(np.linspace(*plotting.window(solution), 5001))
        if np.isfinite(solution.max_pressure):
            assert high >= solution.max_pressure * factor
        cut = any("tension" in text.get_text() for text in bottom.texts)
        if np.isfinite(solution.pressure(solution.zones)).all() and not cut:
            assert low <= pressure.min() * factor

    def test_has_heights_within_the_panel(self, drawn):
        _, figure = drawn
        for top in np.split(np.array(figure.axes), 2)[0]:
            low, high = top.get_ylim()
            surface = lines(top)["contact"][:, 1]
            surface = surface[np.isfinite(surface)]
            assert low < surface.min() and surface.max() < high

    def test_has_its_legend_outside_the_panels(self, drawn):
        _, figure = drawn
        assert len(figure.legends) == 1 and not any(axes.get_legend() for axes in figure.axes)


def prefix_factor(letter: str) -> float:
    """The number that an SI prefix stands for."""
    return {"p": 1e-12, "n": 1e-9, "µ": 1e-6, "m": 1e-3, "": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}[
        letter
    ]


@pytest.mark.parametrize(
    ("name", "shown"),
    [("cohesive", "cohesive tension"), ("sliding", "shear"), ("plastic", "plateau")],
)
def test_the_legend_names_tensions_shears_and_plateaus_of_a_law(name, shown):
    solution = contact.solve(scenes()[name], tol=1e-6)
    figure = plotting.plot(solution)
    assert shown in [text.get_text() for text in figure.legends[0].get_texts()]
    assert shown not in [text.get_text() for text in plotting.plot(westergaard()).legends[0].texts]


@pytest.mark.parametrize(("low", "high"), [(2.0, 30.0), (1e-2, 1e3), (1e-9, 1e-6), (4e4, 6e4)])
def test_logarithmic_axes_have_plain_numbers_or_powers_of_ten(low, high):
    axes = drawing.new_figure(4.0, 3.0).subplots()
    axes.set(yscale="log", ylim=(low, high))
    drawing.log_ticks(axes.yaxis)
    shown = [value for value in axes.yaxis.get_majorticklocs() if low <= value <= high]
    texts = axes.yaxis.get_major_formatter().format_ticks(shown)
    assert len(shown) >= 1
    plain = 1e-4 <= low and high < 1e6
    for value, text in zip(shown, texts, strict=True):
        assert text.startswith("$") != plain
        said = text.strip("$}").replace(r"\times ", "*").replace("^{", "**")
        number = float(text) if plain else eval(said)
        assert number == pytest.approx(value, rel=1e-12)
    assert not any(axes.yaxis.get_minor_formatter().format_ticks([low, high]))


def test_positions_far_from_zero_are_relative_to_the_position_in_the_label():
    whole, close = drawing.stretches((0.0, 1.5e-3), (1.30875e-3 - 2e-7, 1.30875e-3 + 2e-7))
    assert whole.label == "$x$ [µm]" and whole.limits == pytest.approx((0.0, 1500.0))
    assert close.label == "$x$ \N{MINUS SIGN} 1308.75 µm [µm]"
    assert close.limits == pytest.approx((-0.2, 0.2))


WAVE = contact.Scene(contact.Sinusoid(1e-6, L), 1.1e11, contact.Periodic(), mean_pressure=1e9)


@pytest.fixture(scope="module")
def attempts():
    return compare(WAVE, 1e-8)


class TestComparison:
    def test_every_model_has_a_line_of_its_own_also_in_grey(self, attempts):
        styles = comparing.styles_of([attempt.name for attempt in attempts])
        looks = {(repr(one["linestyle"]), grey(one["color"])) for one in styles.values()}
        assert len(looks) == len(styles) == len(attempts)
        shades = [grey(styles[f"m = {m}"]["color"]) for m in NEIGHBOURS]
        assert np.all(np.diff(shades) < -0.05)  # more neighbours are darker

    def test_differences_below_the_stated_errors_are_left_out(self, attempts):
        figure = comparing.plot_comparison(attempts)
        errors = {attempt.name: attempt.solution.error for attempt in attempts}
        _, apart, numbers, _ = figure.axes
        for line in apart.get_lines():
            least = max(errors[line.get_label()], errors["exact"])
            assert np.nanmin(line.get_ydata()) > least
        drawn = np.concatenate([line.get_ydata() for line in numbers.get_lines()])
        assert np.nanmin(drawn) > max(errors.values())
        assert figure.axes[3].get_xlabel() in ("time [ms]", "time [s]")

    def test_imports_and_the_preparation_of_the_profile_are_not_timed(self, monkeypatch):
        solved = []
        monkeypatch.setattr(
            "contact.sweeps.compare.solve", lambda scene, tol: solved.append(scene) or None
        )
        names = [attempt.name for attempt in compare(WAVE, 1e-8)]
        before, timed = solved[: -len(names)], solved[-len(names) :]
        assert [one.interaction for one in before[:-1]] == [one.interaction for one in timed]
        assert before[-1] == timed[0]


def grey(colour: str) -> float:
    """The luminance of a colour: its shade of grey in print."""
    red, green, blue = colors.to_rgb(colour)
    return 0.299 * red + 0.587 * green + 0.114 * blue


class TestSlip:
    @pytest.mark.parametrize("name", ["hertz", "rough", "punch"])
    def test_the_shear_lies_between_the_limits_that_are_drawn(self, name):
        solution = contact.solve(scenes()[name], tol=1e-6)
        figure = contact.partial_slip(solution, 0.3, 0.1 * solution.load).plot()
        assert len(figure.axes) == (2 if name == "rough" else 1) and len(figure.legends) == 1
        for axes in figure.axes:
            assert UNIT.search(axes.get_xlabel()) and axes.get_ylabel().startswith("traction [")
            upper, lower, shear = (line.get_ydata() for line in axes.get_lines()[:3])
            low, high = axes.get_ylim()
            assert low == -high and np.all(lower == -upper)
            assert np.all(np.abs(shear) <= upper + 1e-5 * high)
            if np.isfinite(solution.max_pressure):
                assert upper.max() <= high

    def test_a_second_panel_shows_narrow_zones_of_which_some_stick(self):
        solution = contact.solve(scenes()["light"], tol=1e-6)
        whole, close = contact.partial_slip(solution, 0.3, 0.1 * solution.load).plot().axes
        assert np.ptp(close.get_xlim()) < 0.06 * np.ptp(whole.get_xlim())
        assert "sticks" in [patch.get_label() for patch in close.patches]


class TestStresses:
    @pytest.mark.parametrize("name", ["light", "punch", "cohesive", "plastic"])
    def test_one_unit_of_length_and_round_contours_up_to_the_largest_stress(self, name):
        report = stress_report(contact.solve(scenes()[name], tol=1e-6))
        figure = stresses.plot_stress(report)
        *panels, bar = figure.axes
        below = panels[len(panels) // 2 :]
        units = {UNIT.search(label)[0] for a in below for label in (a.get_xlabel(), a.get_ylabel())}
        assert len(units) == 1
        levels = stresses.levels_to(report.shear.stress if report.shear else 1.7)
        step = levels[1]
        assert np.diff(levels) == pytest.approx(step) and len(levels) <= 18
        assert float(f"{step:e}".split("e")[0]) in (1.0, 2.0, 2.5, 5.0)
        if report.shear is not None:
            top = report.shear.stress / prefix_factor(UNIT.search(bar.get_ylabel())[1])
            assert bar.get_ylim()[1] >= top

    def test_the_strength_is_a_line_that_is_seen_on_light_and_on_dark_ground(self):
        solution = contact.solve(scenes()["hertz"], tol=1e-6)
        report = stress_report(solution, strength=0.5 * solution.max_pressure)
        below = stresses.plot_stress(report, "mises").axes[1]
        effects = [one for one in below.collections if one.get_path_effects()]
        assert len(effects) == 1


def test_neither_pyplot_nor_a_setting_is_touched():
    code = (
        "import contact, matplotlib, sys\n"
        # Reading the setting "backend" would itself load pyplot.
        "settings = lambda: {k: matplotlib.rcParams[k] for k in matplotlib.rcParams if k != 'backend'}\n"
        "before = settings()\n"
        "from contact.solution.plotting import plot\n"
        "wave = contact.Sinusoid(1e-6, 1e-4)\n"
        "plot(contact.solve(contact.Scene(wave, 1e11, contact.Periodic(), mean_pressure=1e8)))\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
        "assert settings() == before\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


class TestUnits:
    @pytest.mark.parametrize(
        ("magnitude", "unit", "multiple"),
        [
            *((1e-6, "m", "µm"), (9.99e-7, "m", "nm"), (1e-3, "m", "mm"), (999.0, "m", "m")),
            *((1e6, "Pa", "MPa"), (2.1e11, "Pa", "GPa"), (5e4, "N/m", "N/mm")),
            *((2e6, "N/m", "kN/mm"), (1.1e11, "N/m^2", "kN/mm²"), (0.05, "J/m^2", "mJ/m²")),
        ],
    )
    def test_a_multiple_brings_a_magnitude_between_one_and_a_thousand(
        self, magnitude, unit, multiple
    ):
        factor, found = scaled(magnitude, unit)
        assert found == multiple
        assert 0.999 < factor * magnitude < 1000

    def test_only_multiples_in_use_are_chosen(self):
        assert quantity(1.2e12, "Pa") == "1200 GPa"
        assert quantity(2e-3, "Pa") == "0.002 Pa"
        assert quantity(3e12, "N/m^2") == "3000 kN/mm²"

    def test_values_have_units_and_undefined_values_are_named_in_words(self):
        assert quantity(2e7, "Pa") == "20 MPa"
        assert quantity(-2.5e-7, "m") == "-250 nm"
        assert quantity(0.0, "m") == "0 m"
        assert quantity(np.inf, "Pa") == "infinite"
        assert quantity(None, "m") == "not defined"
