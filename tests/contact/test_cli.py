"""The commands do what their documentation says, and end with the status 0, 2 or 3.

With the status 2 or 3, they print one clear line on stderr.
"""

from __future__ import annotations

import io
import json
import subprocess
import sys

import numpy as np
import pytest

import contact

pytest.importorskip("click")
pytest.importorskip("rich")

from click.testing import CliRunner  # noqa: E402

from contact.commands import cli  # noqa: E402
from contact.solution import terminal  # noqa: E402
from contact.sweeps import compare as compare_module  # noqa: E402

SCENE = """
[profile]
shape = "sinusoid"
amplitude = 1e-6
period = 1e-4
[material]
E_star = 1.1e11
[interaction]
model = "{model}"
[control]
{control}
"""


@pytest.fixture
def scene(tmp_path):
    def write(control="mean_pressure = 2e7", model="periodic"):
        path = tmp_path / "scene.toml"
        path.write_text(SCENE.format(control=control, model=model))
        return str(path)

    return write


def run(*arguments):
    return CliRunner().invoke(cli.main, [str(argument) for argument in arguments])


def stopped(status, *arguments) -> str:
    """Check that a command ends with this status and one line on stderr only; return the line."""
    result = run(*arguments)
    assert result.exit_code == status, result.output
    assert result.stdout == ""
    assert result.stderr.startswith("contact: ") and result.stderr.count("\n") == 1
    return result.stderr


class TestSolve:
    def test_json_is_one_object_with_the_solution_of_the_python_call(self, scene):
        result = run("solve", scene(), "--json")
        assert result.exit_code == 0 and result.stderr == ""
        read = json.loads(result.stdout)
        expected = contact.solve(contact.load_scene(scene()))
        assert set(read) == {
            "zones", "load", "mean_pressure", "max_pressure", "approach", "contact_fraction", "zone_loads", "zone_widths",
            "stiffness", "mean_gap", "tilt", "moment", "rotational_stiffness", "error", "certificate", "plan", "warnings",
            "zone_peaks", "scene", "tangential_load", "trace", "units", "version",
        }  # fmt: skip
        assert read["zones"] == expected.zones.tolist()
        assert read["mean_pressure"] == pytest.approx(2e7, rel=1e-12)

    def test_the_zone_is_westergaards(self, scene):
        ((left, right),) = json.loads(run("solve", scene(), "--json").stdout)["zones"]
        a = 1e-4 / np.pi * np.arcsin(np.sqrt(2e7 * 1e-4 / (np.pi * 1.1e11 * 1e-6)))
        assert [left, right] == pytest.approx([-a, a], rel=1e-8)
        assert right != pytest.approx(1.001 * a, rel=1e-8)

    def test_tables_name_the_quantities_with_units(self, scene):
        result = run("solve", scene())
        assert result.exit_code == 0
        for word in ("20 MPa", "contact fraction", "smallest gap", "error"):
            assert word in result.stdout

    def test_files_asked_for_are_written(self, scene, tmp_path):
        pytest.importorskip("h5py")
        pytest.importorskip("matplotlib")
        names = {"--save": "out.nc", "--plot": "out.png", "--csv": "out.csv"}
        result = run(
            "solve",
            scene(),
            *(part for option, name in names.items() for part in (option, tmp_path / name)),
        )
        assert result.exit_code == 0, result.output
        assert (tmp_path / "out.nc").read_bytes().startswith(b"\x89HDF")
        assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")
        assert (tmp_path / "out.csv").read_text().count("\n") == 2

    def test_json_stays_one_object_when_files_are_written(self, scene, tmp_path):
        json.loads(run("solve", scene(), "--json", "--csv", tmp_path / "out.csv").stdout)

    def test_numbers_are_written_over_only_when_asked_and_a_picture_is_drawn_anew(
        self, scene, tmp_path, monkeypatch
    ):
        pytest.importorskip("matplotlib")
        table, figure = tmp_path / "out.csv", tmp_path / "out.png"
        for path in (table, figure):
            path.write_text("mine")
        solve = cli.solve
        monkeypatch.setattr(cli, "solve", lambda *a, **k: pytest.fail("solved"))
        refused = stopped(2, "solve", scene(), "--csv", table, "--plot", figure)
        assert "--csv" in refused and "--overwrite" in refused
        monkeypatch.setattr(cli, "solve", solve)
        assert run("solve", scene(), "--csv", table, "--overwrite").exit_code == 0
        assert run("solve", scene(), "--plot", figure).exit_code == 0
        assert table.read_text().startswith("left") and figure.read_bytes().startswith(b"\x89PNG")

    def test_two_options_cannot_name_one_file(self, scene, tmp_path):
        assert "--fields" in stopped(
            2, "solve", scene(), "--csv", tmp_path / "out.csv", "--fields", tmp_path / "out.csv"
        )

    @pytest.mark.parametrize("option", ["--save", "--csv", "--fields"])
    def test_a_file_of_numbers_with_a_wrong_ending_is_refused_before_solving(
        self, scene, tmp_path, monkeypatch, option
    ):
        monkeypatch.setattr(cli, "solve", lambda *a, **k: pytest.fail("solved"))
        assert option in stopped(2, "solve", scene(), option, tmp_path / "out.txt")

    def test_a_scene_comes_in_on_standard_input(self, scene):
        text = open(scene(), encoding="utf-8").read()
        result = CliRunner().invoke(cli.main, ["solve", "-", "--json"], input=text)
        assert (
            json.loads(result.stdout)["zones"]
            == json.loads(run("solve", scene(), "--json").stdout)["zones"]
        )
        for broken in ("", "[profile", text.replace("amplitude", "amplitud"), "\xff"):
            refused = CliRunner().invoke(cli.main, ["solve", "-"], input=broken.encode("latin-1"))
            assert refused.exit_code == 2 and refused.stderr.startswith("contact: standard input: ")

    def test_quietly_it_writes_its_files_and_prints_nothing(self, scene, tmp_path):
        result = run("solve", scene(), "-q", "--csv", tmp_path / "out.csv")
        assert (result.exit_code, result.output) == (0, "") and (tmp_path / "out.csv").exists()

    def test_another_package_of_the_same_name_is_warned_of(self, monkeypatch):
        monkeypatch.setattr(cli, "other_package", lambda: "contact 9, another project")
        assert run("profiles").stderr == "contact: warning: contact 9, another project\n"

    def test_full_contact_is_printed_in_words(self, scene):
        result = run("solve", scene("mean_pressure = 4e9"))
        assert result.exit_code == 0
        assert "full contact" in result.stdout

    @pytest.mark.parametrize("name", ["out.xyz", "none/out.png", "out", ""])
    def test_a_figure_that_cannot_be_written_is_refused_before_solving(
        self, scene, tmp_path, monkeypatch, name
    ):
        monkeypatch.setattr(cli, "solve", lambda *a, **k: pytest.fail("solved"))
        assert "--plot" in stopped(2, "solve", scene(), "--plot", tmp_path / name)

    def test_a_progress_callable_reaches_the_solver(self, scene, monkeypatch):
        given = {}

        def solve(problem, tol, progress, branch):
            given.update(tol=tol, progress=progress)
            return contact.solve(problem, tol=tol)

        monkeypatch.setattr(cli, "solve", solve)
        assert run("solve", scene(), "--tol", "1e-6").exit_code == 0
        assert given["tol"] == 1e-6 and callable(given["progress"])


TRACE = """
profile = {shape = "sampled", file = "trace.csv", units = "um", period = true}
material = {E_star = 1e11}
interaction = {model = "periodic"}
control = {mean_pressure = 1e7}
"""


@pytest.mark.parametrize(
    "command",
    [
        ["solve"],
        ["plan", "--solve"],
        ["compare"],
        ["path", "--loads", "1e2,1.1e2"],
        ["sweep", "--vary", "control.load=1e2,1.1e2", "--out"],
    ],
    ids=lambda command: command[0],
)
def test_every_solve_of_a_trace_says_what_it_read(command, tmp_path):
    pytest.importorskip("h5netcdf")
    x = np.linspace(0.0, 100.0, 41)
    np.savetxt(
        tmp_path / "trace.csv", np.column_stack((x, np.cos(2 * np.pi * x / 100))), delimiter=","
    )
    (tmp_path / "trace.toml").write_text(TRACE)
    name, *options = [*command, str(tmp_path / "out.nc")] if command[-1] == "--out" else command
    result = run(name, tmp_path / "trace.toml", *options)
    assert result.exit_code == 0, result.output
    assert "41 points of trace.csv" in result.stdout and "rms slope" in result.stdout


def test_the_shell_completes_commands_and_options(monkeypatch, capsys):
    for words, place, expected in (
        ("contact so", 1, {"solve"}),
        ("contact path --b", 2, {"--back"}),
    ):
        monkeypatch.setenv("_CONTACT_COMPLETE", "bash_complete")
        monkeypatch.setenv("COMP_WORDS", words)
        monkeypatch.setenv("COMP_CWORD", str(place))
        with pytest.raises(SystemExit):
            cli.main.main(prog_name="contact")
        assert {line.partition(",")[2] for line in capsys.readouterr().out.split()} == expected


class TestFailures:
    def test_a_missing_file_is_named(self, tmp_path):
        assert "none.toml" in stopped(2, "solve", tmp_path / "none.toml")

    def test_broken_toml_is_named(self, tmp_path):
        (tmp_path / "broken.toml").write_text("[profile")
        assert "TOML" in stopped(2, "plan", tmp_path / "broken.toml")

    @pytest.mark.parametrize("command", ["solve", "plan", "compare"])
    def test_a_bad_value_is_named(self, scene, command):
        assert "mean_pressure" in stopped(2, command, scene("mean_pressure = -1"))

    def test_a_control_that_no_contact_can_have_ends_in_2(self, scene):
        stopped(2, "solve", scene("approach = 1e-5"))

    @pytest.mark.parametrize("tol", ["0", "-1", "nan", "x"])
    def test_an_invalid_tolerance_is_refused(self, scene, tol):
        assert "tol" in stopped(2, "solve", scene(), "--tol", tol)

    @pytest.mark.parametrize(
        "arguments", [["frob"], ["solve"], ["solve", "a", "b"], ["solve", "a", "--frob"]]
    )
    def test_wrong_usage_ends_in_2(self, arguments):
        stopped(2, *arguments)

    def test_no_convergence_ends_in_3_with_one_line_however_many_the_message_has(
        self, scene, monkeypatch
    ):
        def solve(*arguments, **options):
            raise contact.NotConverged("error 3e-3\n  after 50 steps", trace=[1])

        monkeypatch.setattr(cli, "solve", solve)
        assert stopped(3, "solve", scene()) == "contact: error 3e-3 after 50 steps\n"

    def test_a_missing_extra_ends_in_2(self, scene, monkeypatch, tmp_path):
        monkeypatch.setitem(sys.modules, "matplotlib.backends.backend_agg", None)
        assert "[plot]'" in stopped(2, "solve", scene(), "--plot", tmp_path / "out.png")

    def test_without_click_the_command_says_what_to_install(self):
        code = "import sys; sys.modules['click'] = None; from contact.__main__ import main; main()"
        done = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=False
        )
        assert done.returncode == 2
        assert done.stderr.count("\n") == 1 and "pip install click" in done.stderr


class TestPlan:
    def test_it_says_what_is_used_and_left_out_without_solving(self, scene, monkeypatch):
        monkeypatch.setattr(cli, "solve", lambda *a, **k: pytest.fail("solved"))
        result = run("plan", scene())
        assert result.exit_code == 0
        expected = contact.plan(contact.load_scene(scene()))
        for part in expected.parts:
            assert part.name in result.stdout
            assert part.reason.split(":")[0] in result.stdout

    def test_solved_it_also_says_the_sizes_and_where_the_time_went(self, scene):
        result = run("plan", scene(), "--solve")
        assert result.exit_code == 0
        header = next(line for line in result.stdout.splitlines() if "reason" in line)
        assert header.split()[-2:] == ["time", "share"]
        for name in (
            "zones",
            "own modes",
            "coupled unknowns",
            "kernel evaluations",
            "profile evaluations",
            "total time",
        ):
            assert name in result.stdout


class TestCompare:
    def test_the_models_stand_side_by_side_and_the_exact_one_last(self, scene):
        result = run("compare", scene())
        assert result.exit_code == 0, result.output
        lines = [line.strip() for line in result.stdout.splitlines()]
        names = (
            "isolated",
            "first-order",
            "self-consistent",
            "m = 1",
            "m = 2",
            "m = 4",
            "m = 8",
            "exact",
        )
        listed = [name for line in lines for name in names if line.startswith(name)]
        assert listed == [*names] * 3
        exact = [line.split() for line in lines if line.startswith("exact")][1]
        assert exact[1:6] == ["0"] * 5

    @pytest.mark.parametrize(
        "control",
        ["mean_pressure = 2e7", "mean_pressure = 2.6e9", "contact_fraction = 0.123456789"],
    )
    def test_no_line_of_a_comparison_is_wider_than_80_columns(self, scene, control):
        result = run("compare", scene(control))
        tables = result.stdout.partition("no solution")[0].splitlines()
        assert max(len(line.rstrip()) for line in tables if "," not in line) <= 80

    def test_a_column_of_a_comparison_has_one_unit_in_its_head(self, scene):
        lines = run("compare", scene("mean_pressure = 2.6e9")).stdout.splitlines()
        assert sum(line.count("[") for line in lines) == 4 + 1 + 2
        assert not any(
            unit in line for line in lines if "m = " in line for unit in ("Pa", "µm", "nm", "kN")
        )

    def test_a_model_without_a_solution_says_why_and_the_others_go_on(self, scene):
        result = run("compare", scene("approach = 3e-7"))
        assert result.exit_code == 0
        reason = next(
            line for line in result.stdout.splitlines() if line.startswith("isolated: no solution")
        )
        assert "datum" in reason

    def test_the_models_own_parameters_are_compared_too(self, scene, tmp_path):
        model = 'localized"\nclosure = "self-consistent"\nneighbours = 3\n#"'
        (tmp_path / "own.toml").write_text(SCENE.format(model=model, control="load = 2000.0"))
        result = run("compare", tmp_path / "own.toml")
        assert result.exit_code == 0, result.output
        assert "localized, as given" in result.stdout

    def test_every_neighbour_brings_the_zones_nearer_to_the_exact_ones(self, scene):
        result = run("compare", scene("mean_pressure = 2.6e9"))
        assert result.exit_code == 0, result.output
        differences = result.stdout.partition("from the exact model")[2].partition("zone ends")[0]
        rows = [line.split()[-3] for line in differences.splitlines()[6:] if line.strip()]
        errors = [float(word) for word in rows if word != "-"]
        # The zone of the isolated model would reach the border of its cell, so its row has no
        # number.
        assert errors[-1] == 0 and len(errors) == 7
        assert errors[1] > errors[2] > 3 * errors[3] > 9 * errors[4] > 30 * errors[5] > 0

    def test_the_comparison_is_drawn_where_asked(self, scene, tmp_path):
        pytest.importorskip("matplotlib")
        out = tmp_path / "compared.png"
        assert run("compare", scene("mean_pressure = 2.6e9"), "--plot", out).exit_code == 0
        assert out.read_bytes().startswith(b"\x89PNG")
        assert "--plot" in stopped(2, "compare", scene(), "--plot", tmp_path / "compared.what")

    @pytest.mark.parametrize(
        ("error", "status"), [(contact.OutOfRange, 2), (contact.NotConverged, 3)]
    )
    def test_no_model_with_a_solution_ends_as_solve_would(self, scene, monkeypatch, error, status):
        def solve(problem, tol):
            raise error(f"{problem.interaction.name} has none")

        monkeypatch.setattr(compare_module, "solve", solve)
        result = run("compare", scene())
        assert result.exit_code == status
        assert result.stderr.count("\n") == 1
        # Each reason has one line, with the models for which it holds.
        assert result.stdout.count("no solution: ") == 3
        assert (
            "first-order, self-consistent, m = 1, m = 2, m = 4, m = 8: no solution: localized has none"
            in result.stdout
        )


class TestLists:
    def test_every_profile_is_listed_with_its_parameters(self):
        result = run("profiles")
        assert result.exit_code == 0
        for name in contact.profiles():
            assert name in result.stdout
        assert "amplitude, period" in result.stdout and "detrend = 'none'" in result.stdout

    @pytest.mark.parametrize(
        "command, names", [("substrates", ("half-plane", "layer")), ("laws", ("frictionless",))]
    )
    def test_every_substrate_and_law_is_listed(self, command, names):
        result = run(command)
        assert result.exit_code == 0
        assert all(name in result.output for name in names)

    def test_every_interaction_is_listed_with_its_controls(self):
        result = run("interactions")
        assert result.exit_code == 0
        for name in contact.interactions():
            assert name in result.stdout
        assert "contact_fraction" in result.stdout

    def test_no_command_shows_the_help(self):
        result = run()
        assert result.exit_code == 0
        assert "compare" in result.stdout


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


class TestProgress:
    def test_a_bar_appears_on_a_terminal_once_the_work_has_lasted(self, monkeypatch):
        screen, now = Terminal(), [0.0]
        monkeypatch.setattr(sys, "stderr", screen)
        with terminal.Progress(patience=1.0, clock=lambda: now[0]) as progress:
            progress("zone ends", 1, 3)
            assert screen.getvalue() == ""
            now[0] = 1.5
            progress("zone ends", 2, 3)
            progress("certificate", 0, None)
        assert "certificate" in screen.getvalue() or "zone ends" in screen.getvalue()

    def test_nothing_is_written_where_stderr_is_no_terminal(self, monkeypatch):
        screen = io.StringIO()
        monkeypatch.setattr(sys, "stderr", screen)
        with terminal.Progress(patience=0.0) as progress:
            progress("zone ends", 1, 3)
        assert screen.getvalue() == ""


def test_importing_contact_loads_nothing_the_command_line_or_a_figure_needs():
    heavy = (
        "click",
        "rich",
        "matplotlib",
        "xarray",
        "h5netcdf",
        "h5py",
        "pydantic",
        "contact.commands.cli",
    )
    code = f"import sys, contact; print([name for name in {heavy!r} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def with_friction(path, lines):
    text = open(path).read()
    open(path, "w").write(f"{text}[tangential]\n{lines}\n")
    return path


def test_slip_prints_what_python_gives(scene, tmp_path):
    path = with_friction(scene(), "friction = 0.3\nload = 300.0")
    printed = json.loads(run("slip", path, "--json").stdout)
    slip = contact.partial_slip(contact.solve(contact.load_scene(path)), 0.3, 300.0)
    assert printed["stick_zones"] == slip.stick_zones.tolist()
    assert printed["tangential_load"] == 300.0 and printed["model"] == "partial slip"
    shown = run("slip", path, "--csv", tmp_path / "z.csv", "--plot", tmp_path / "q.png")
    assert shown.exit_code == 0 and "stick" in shown.stdout
    assert (tmp_path / "z.csv").read_text().startswith("left,right,width,state")


def test_slip_solves_rolling_if_the_scene_asks_for_it(tmp_path):
    path = tmp_path / "wheel.toml"
    path.write_text(
        'profile = {shape = "parabola", radius = 1.0}\nmaterial = {E_star = 1e9}\n'
        'interaction = {model = "isolated"}\ncontrol = {load = 1e4}\n'
    )
    with_friction(path, 'model = "rolling"\nfriction = 0.3\ncreepage = 1e-4')
    printed = json.loads(run("slip", path, "--json").stdout)
    assert printed["creepage"] == pytest.approx(1e-4) and printed["tangential_load"] > 0


@pytest.mark.parametrize(
    ("lines", "named"),
    [
        ("friction = 0.3", "load or creepage"),
        ("load = 1.0", "friction is missing"),
        ("friction = -0.3\nload = 1.0", "friction"),
        ("friction = 0.3\nload = 1e9", "at most friction"),
        ("friction = 0.3\ncreepage = 1e-3", "rolling"),
        ('friction = 0.3\nload = 1.0\nmodel = "slip"', "model"),
        ("friction = 0.3\nload = 1.0\nfrict = 1.0", "frict"),
    ],
)
def test_slip_names_what_is_wrong_in_its_table(scene, lines, named):
    assert named in stopped(2, "slip", with_friction(scene(), lines))
    if named != "at most friction":  # every command that reads the file checks the table
        assert named in stopped(2, "solve", with_friction(scene(), lines))


def test_slip_refuses_bodies_that_are_not_alike(scene):
    path = scene()
    text = open(path).read()
    open(path, "w").write(text.replace("E_star = 1.1e11", "E1 = 2.1e11\nnu1 = 0.3"))
    assert "beta" in stopped(2, "slip", with_friction(path, "friction = 0.3\nload = 1.0"))
    assert "[tangential] is missing" in stopped(2, "slip", scene())
