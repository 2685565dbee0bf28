"""Scenes at the limits of the model are solved with a warning.

It is a warning of Python, one line on stderr, and a field of the solution.
"""

from __future__ import annotations

import json
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import contact

pytest.importorskip("click")

from click.testing import CliRunner  # noqa: E402

from contact.commands import cli  # noqa: E402
from contact.solution import model_warnings  # noqa: E402
from contact.sweeps import compare as compare_module  # noqa: E402

PERIODIC, ISOLATED = contact.Periodic(), contact.Isolated()
L = 1e-4
EXAMPLES = Path(__file__).parents[2] / "examples"


def told(call) -> list[str]:
    """The messages of all warnings of a call; each must be a ModelWarning of the calling line."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        call()
    assert all(warning.category is contact.ModelWarning for warning in caught)
    assert all(Path(warning.filename) == Path(__file__) for warning in caught), (
        "of the line that called"
    )
    return [str(warning.message) for warning in caught]


def scene(profile, E_star=1.1e11, interaction=PERIODIC, **control) -> contact.Scene:
    return contact.Scene(profile, E_star, interaction, **control)


STEEP = scene(contact.Sinusoid(1e-3, L), mean_pressure=2e7)  # slopes of 63
PRESSED = scene(contact.Parabola(1e-2), interaction=ISOLATED, load=2e8)
RIGID = scene(contact.Sinusoid(1e-6, L), 1e40, mean_pressure=2e7)
IN_GPA = scene(contact.Sinusoid(1e-6, L), 110.0, contact_fraction=0.1)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (STEEP, ("slopes up to 63", "pressure of")),
        (PRESSED, ("slopes up to", "pressure of")),
        (RIGID, ("E_star = 1e+40",)),
        (IN_GPA, ("E_star = 110",)),
        (
            scene(contact.Wedge(0.5), 1.0, ISOLATED, load=1.0),
            ("slopes up to 0.5", "mean contact pressure"),
        ),
        (
            scene(contact.Flat(1.0), 1.0, ISOLATED, load=0.3),
            ("mean contact pressure of 0.3 Pa, which is 0.3 E*",),
        ),
        (scene(contact.Sinusoid(0.02, 1.0), 1.0, mean_pressure=0.2), ("pressure of",)),
        (
            scene(contact.Sinusoid(1.0, 100.0), contact_fraction=0.1),
            ("a profile 100 m long",),
        ),  # lengths in micrometres
        (scene(contact.Parabola(50.0, 20.0), contact_fraction=0.01), ("a profile 20 m long",)),
        (scene(contact.Flat(40.0), interaction=ISOLATED, load=1e3), ("a profile 40 m long",)),
        (
            scene(
                contact.Sampled(np.arange(8.0), 0.1 * np.cos(np.arange(8.0)), period=8.0),
                contact_fraction=0.1,
            ),
            ("8 m long",),
        ),
        (scene(contact.Fourier(1e-10, [1e-12]), contact_fraction=0.5), ("100 pm long",)),
        (scene(contact.Sinusoid(1e-12, L), contact_fraction=0.5), ("less than an atom",)),
    ],
    ids="steep pressed rigid GPa wedge punch full micrometres rollers width points short shallow".split(),
)
def test_scenes_at_the_limits_of_the_model_are_solved_with_a_warning(given, words):
    solution = []
    messages = told(lambda: solution.append(contact.solve(given)))
    assert len(messages) == len(words) and all(
        word in message for word, message in zip(words, messages, strict=True)
    )
    assert solution[0].warnings == messages
    assert issubclass(contact.ModelWarning, UserWarning)


@pytest.mark.parametrize(
    "given",
    [
        scene(contact.Sinusoid(0.01, 1.0), 1.0, mean_pressure=0.01),
        scene(contact.Parabola(1.0), 1.0, ISOLATED, load=1e-3),
        scene(contact.Wedge(0.1, 2.0), 3.0, load=1e-2),
        scene(contact.Flat(1.0), 1.0, ISOLATED, load=1e-3),
        scene(contact.Sinusoid(1e-6, L), 1.0, mean_pressure=1e-3),  # pressures in units of E*
        scene(contact.Parabola(1.0), 1e-9, ISOLATED, load=1e-12),
        scene(contact.Parabola(1.0), 1e11, ISOLATED, load=1e3),
        scene(contact.Sinusoid(1e-3, 5.0), 2.1e5, mean_pressure=1.0),  # millimetres and megapascals
        scene(
            contact.Sampled(np.arange(8.0), 0.1 * np.cos(np.arange(8.0)), period=8.0),
            1.0,
            mean_pressure=1e-3,
        ),
    ],
    ids="wave parabola wedge punch modulus soft roller megapascals trace".split(),
)
def test_dimensionless_numbers_and_other_units_cause_no_warning(given):
    assert told(lambda: contact.solve(given)) == []


@pytest.mark.parametrize(
    "name", [path.name for path in sorted(EXAMPLES.glob("*.toml")) if "stylus" not in path.name]
)
def test_no_example_is_warned_of(name):
    assert told(lambda: contact.solve(contact.load_scene(EXAMPLES / name), tol=1e-5)) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", ["stylus.toml", "stylus-ground.toml"])
def test_no_measured_example_is_warned_of(name):
    """The peak pressures, 8 and 12 GPa (0.035 and 0.053 of E*), exceed the hardness of steel."""
    test_no_example_is_warned_of(name)


def test_the_angle_of_a_turned_body_does_not_count_as_a_steep_slope():
    turned = scene(contact.Parabola(1.0), 1.0, ISOLATED, load=1e-4, tilt=0.5)
    assert told(lambda: contact.solve(turned)) == []


def test_a_path_a_comparison_and_an_approach_warn_once():
    assert (
        len(told(lambda: contact.path(scene(contact.Sinusoid(1e-3, L), load=1.0), [1.0, 2.0, 3.0])))
        == 1
    )
    assert len(told(lambda: compare_module.compare(replace(STEEP, mean_pressure=1e6)))) == 1
    by_approach = scene(contact.Parabola(1.0), 1.0, contact.Isolated(datum=10.0), approach=0.4)
    assert [message[:6] for message in told(lambda: contact.solve(by_approach))].count(
        "slopes"
    ) <= 1


def test_a_scene_that_cannot_be_solved_causes_its_warning_too():
    def solve():
        with pytest.raises(contact.OutOfRange):
            contact.solve(scene(contact.Sinusoid(1e-6, L), 110.0, approach=1.0))

    assert len(told(solve)) == 1


class TestTraces:
    ROWS = "".join(f"{0.4 * i:.1f},{np.sin(i):.4f}\n" for i in range(10_001))

    @pytest.fixture
    def trace(self, tmp_path) -> Path:
        (tmp_path / "trace.csv").write_text(self.ROWS)
        return tmp_path / "trace.csv"

    @pytest.mark.parametrize(
        ("units", "words"),
        [
            (None, ("4 km long", "pitch of 400 mm", "(no units given)")),
            ("m", ("4 km long", '"m"')),
            ("mm", ("4 m long",)),
            ("pm", ("4 nm long", "pitch of 0.4 pm")),
        ],
    )
    def test_a_trace_with_implausible_lengths_causes_a_warning_when_it_is_read(
        self, trace, units, words
    ):
        read = []
        (message,) = told_here = told(
            lambda: read.append(contact.Sampled.from_file(trace, units=units))
        )
        assert all(word in message for word in words), message
        assert read[0].warnings == (*told_here,)

    @pytest.mark.parametrize("units", ["um", "nm", ["um", "nm"]])
    def test_a_trace_with_plausible_lengths_causes_no_warning(self, trace, units):
        assert told(lambda: contact.Sampled.from_file(trace, units=units)) == []

    def test_a_period_in_the_units_of_the_file_is_warned_of(self, trace):
        (message,) = told(lambda: contact.Sampled.from_file(trace, units="um", period=4001.0))
        assert "4 mm long" in message and "period of 4.001 km" in message and "in metres" in message
        assert told(lambda: contact.Sampled.from_file(trace, units="um", period=4001e-6)) == []

    def test_heights_within_an_atom_are_warned_of(self, trace):
        (message,) = told(lambda: contact.Sampled.from_file(trace, units=["um", "pm"]))
        assert "less than an atom" in message
        assert told(lambda: contact.Sampled.from_file(trace, units=["um", "A"])) == []


@pytest.mark.filterwarnings("always::contact.ModelWarning")
class TestCommandLine:
    SCENE = (
        '[profile]\nshape = "sinusoid"\namplitude = {}\nperiod = 1e-4\n[material]\nE_star = {}\n'
        '[interaction]\nmodel = "periodic"\n[control]\nmean_pressure = 2e7\n'
    )

    def run(self, folder: Path, amplitude: float, E_star: float, *options: str):
        (folder / "scene.toml").write_text(self.SCENE.format(amplitude, E_star))
        return CliRunner().invoke(cli.main, ["solve", str(folder / "scene.toml"), *options])

    def test_a_warning_is_one_line_on_stderr_and_a_field_of_the_json(self, tmp_path):
        result = self.run(tmp_path, 1e-3, 1e40, "--json")
        assert result.exit_code == 0
        said = json.loads(result.stdout)["warnings"]
        assert result.stderr == "".join(f"contact: warning: {message}\n" for message in said)
        with pytest.warns(contact.ModelWarning):
            assert said == contact.solve(contact.load_scene(tmp_path / "scene.toml")).warnings
        assert len(said) == 2

    def test_without_a_warning_the_list_and_stderr_are_empty(self, tmp_path):
        result = self.run(tmp_path, 1e-6, 1.1e11, "--json")
        assert json.loads(result.stdout)["warnings"] == [] and result.stderr == ""

    def test_a_trace_read_in_the_wrong_units_causes_one_warning(self, tmp_path):
        x = np.arange(100)
        rows = "".join(
            f"{a},{b:.6f}\n" for a, b in zip(x, 0.01 * np.cos(2 * np.pi * x / 50), strict=True)
        )
        (tmp_path / "trace.csv").write_text(rows)
        tables = (
            '[profile]\nshape = "sampled"\nfile = "trace.csv"\nperiod = 100\n[material]\nE_star = 1e11\n'
            '[interaction]\nmodel = "periodic"\n[control]\nmean_pressure = 1e4\n'
        )
        (tmp_path / "scene.toml").write_text(tables)
        result = CliRunner().invoke(cli.main, ["solve", str(tmp_path / "scene.toml"), "--json"])
        assert result.exit_code == 0, result.stderr
        (said,) = json.loads(result.stdout)["warnings"]
        assert "99 m long" in said and result.stderr == f"contact: warning: {said}\n"

    def test_the_filter_of_python_can_turn_the_warning_into_an_error(self, tmp_path):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            result = self.run(tmp_path, 1e-3, 1.1e11)
        assert (
            result.exit_code == 2
            and result.stderr.startswith("contact: slopes")
            and result.stderr.count("\n") == 1
        )


def test_the_check_for_warnings_evaluates_few_slopes_and_pressures(monkeypatch):
    given = scene(contact.Sinusoid(1e-6, L), mean_pressure=2e7)
    solution = contact.solve(given)
    counts = {"slope": 0, "pressure": 0}
    for name, owner in (("slope", contact.Sinusoid), ("pressure", contact.Solution)):
        plain = getattr(owner, name)

        def counted(self, x, name=name, plain=plain):
            counts[name] += np.size(x)
            return plain(self, x)

        monkeypatch.setattr(owner, name, counted)
    model_warnings.scene_and_solution_warnings(solution)
    assert counts["slope"] <= 1100 and counts["pressure"] <= 8
