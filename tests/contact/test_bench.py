"""Tests of the benchmarks: exact solutions, errors, verdicts and the files that they write."""

from __future__ import annotations

import csv
import dataclasses
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import contact
from contact.commands.cli import main
from contact.reference import inverse
from contact.reference.exact import HertzLine, IsolatedWedge, Westergaard
from contact.studies import ablation, pages, shortened
from contact.studies.bench import (
    cases,
    clock,
    curves,
    extremes,
    peers,
    report,
    run,
    scaling,
    stability,
    truth,
)
from contact.studies.bench.extremes.shapes import units
from contact.studies.bench.harmonics import HarmonicZone
from contact.studies.bench.hyperbola import BluntedWedge, IsolatedBluntedWedge
from contact.studies.bench.one_gap import OneGap
from contact.studies.bench.one_zone import ByPieces
from contact.studies.bench.power import PowerPunch, Repeated
from contact.studies.bench.precision import Row, hierarchy, ours
from contact.studies.bench.truncated import IsolatedTruncatedWedge, TruncatedWedge

ROOT = Path(__file__).parents[2]
T = np.linspace(-0.98, 0.98, 15)


def transform_at(pressure, x, nodes=4000):
    """(1/pi) PV int p(xi)/(x - xi) dxi on [-1, 1], x between the nodes."""
    phi = (np.arange(nodes) + 0.5) * np.pi / nodes
    xi = np.cos(phi)
    return float(np.sum(pressure(xi) * np.sin(phi) * np.pi / nodes / (x - xi))) / np.pi


class TestTruths:
    def test_one_harmonic_is_westergaard_s_wave(self):
        wave = Westergaard(amplitude=0.01, period=1.0, E_star=1.0, half_width=0.4)
        series = HarmonicZone((0.01,), 1.0, 0.4)
        assert series.load == pytest.approx(wave.load, rel=1e-14)
        assert np.abs(series.pressure_at(T) - wave.pressure_at(T)).max() < 1e-14 * wave.max_pressure

    def test_the_pressure_of_a_series_has_its_load(self):
        series = HarmonicZone((0.01, 0.0, 2e-4), 1.0, 0.4)
        phi = (np.arange(200) + 0.5) * np.pi / 200
        assert 0.4 * np.pi / 200 * np.sum(
            series.pressure_at(np.cos(phi)) * np.sin(phi)
        ) == pytest.approx(series.load, rel=1e-12)

    def test_a_wedge_blunted_by_little_is_a_wedge_away_from_its_tip(self):
        sharp = IsolatedWedge(wedge_slope=0.1, E_star=1.0, half_width=1.0)
        t = np.array([0.1, 0.5, 0.9])
        gaps = [
            np.abs(
                IsolatedBluntedWedge(0.1, d, 1.0, 1.0).pressure_at(t) - sharp.pressure_at(t)
            ).max()
            for d in (1e-3, 1e-4)
        ]
        assert gaps[1] < 0.02 * gaps[0] < 1e-6

    def test_a_wedge_blunted_by_much_is_hertz_s_parabola(self):
        hertz = HertzLine(radius=1e3, E_star=1.0, half_width=1.0)
        blunt = IsolatedBluntedWedge(1.0, 1e3, 1.0, 1.0)
        assert blunt.load == pytest.approx(hertz.load, rel=1e-5)

    @pytest.mark.parametrize(
        ("exact", "slope"),
        [
            (PowerPunch(2), lambda x: x),
            (PowerPunch(6), lambda x: x**5),
            (IsolatedBluntedWedge(0.1, 0.3, 1.0, 1.0), BluntedWedge(0.1, 0.3).slope),
        ],
    )
    def test_the_transform_of_the_pressure_is_half_the_slope(self, exact, slope):
        x = np.cos(np.pi * np.array([800, 1500, 2400]) / 4000)
        assert [transform_at(exact.pressure_at, v) for v in x] == pytest.approx(
            0.5 * slope(x), rel=1e-6
        )

    def test_the_transform_of_another_pressure_is_not_half_the_slope(self):
        x = np.cos(np.pi * 800 / 4000)
        assert transform_at(lambda t: 1.001 * PowerPunch(6).pressure_at(t), x) != pytest.approx(
            0.5 * x**5, rel=1e-4
        )

    @pytest.mark.parametrize(("part", "rounding"), [(1e-3, 1e-13), (1e-6, 1e-11)])
    def test_one_gap_in_closed_form_is_the_one_that_the_solver_finds(self, part, rounding):
        profile = contact.Fourier(1.0, [-1e-3, 2e-4], [3e-4])
        full = contact.solve(
            contact.Scene(profile, 1.0, contact.Periodic(), contact_fraction=1.0)
        ).mean_pressure
        scene = contact.Scene(profile, 1.0, contact.Periodic(), mean_pressure=full * (1 - part))
        found, exact = contact.solve(scene, 1e-10), OneGap.of(profile, full, scene)
        assert truth.stated_measure(found, exact) < rounding

    def test_one_gap_of_a_wave_is_westergaard_s(self):
        wave = Westergaard.from_contact_fraction(0.6, amplitude=1e-3, period=1.0, E_star=1.0)
        profile = contact.Fourier(1.0, [-1e-3], [0.0])
        scene = contact.Scene(profile, 1.0, contact.Periodic(), mean_pressure=wave.mean_pressure)
        assert truth.stated_measure(OneGap.of(profile, np.pi * 1e-3, scene), wave) < 1e-14

    def test_one_zone_by_quadrature_is_the_truncated_wedge_s(self):
        exact = IsolatedTruncatedWedge(0.1, 0.3, 1.0, 1.0)
        zone = ByPieces(TruncatedWedge(0.1, 0.3), np.array([-0.3, 0.3]), 1.0, 1.0)
        assert zone.load == pytest.approx(exact.load, rel=1e-14)
        assert zone.pressure_at(T) == pytest.approx(exact.pressure_at(T), rel=1e-12)

    def test_equal_zones_repeat_one_wave_and_lie_in_one_period(self):
        one = Westergaard.from_contact_fraction(0.1, amplitude=1e-4, period=0.25, E_star=1.0)
        four = Repeated(one, 4, 0.3)
        assert np.all((four.zones[:, 0] >= -0.5) & (four.zones[:, 0] < 0.5)) and np.allclose(
            np.diff(four.zones[:, 0]), 0.25
        )
        assert four.pressure(np.mean(four.zones, axis=1)) == pytest.approx(
            np.full(4, one.max_pressure), rel=1e-12
        )

    def test_both_formulations_of_a_nearly_full_rough_contact_agree(self):
        case = cases.rough_nearly_full()
        solution = contact.solve(case.scene, 1e-10)
        assert solution.certificate.note == "solved by its gaps"
        assert truth.stated_measure(solution, case.exact) < 1e-10


class TestMeasures:
    def test_an_end_moved_by_1e_6_of_the_width_is_an_error_of_1e_6(self):
        exact = Westergaard(amplitude=0.01, period=1.0, E_star=1.0, half_width=0.2)
        moved = Westergaard(amplitude=0.01, period=1.0, E_star=1.0, half_width=0.2 * (1 + 2e-6))
        assert truth.stated_measure(moved, exact) == pytest.approx(1e-6, rel=2.0)
        assert truth.stated_measure(exact, exact) == 0.0

    def test_another_number_of_zones_is_no_solution(self):
        two = inverse.design([[0.0, 0.2], [0.4, 0.7]], 1.0, 1e-3, 1.0)
        assert (
            truth.stated_measure(HertzLine(radius=1.0, E_star=1.0, half_width=1.0), two) == np.inf
        )

    def test_a_run_reaches_an_error_only_if_all_finer_grids_reach_it_too(self):
        def row(error, seconds):
            return Row("s", "m", 0, seconds, error, error, None, None, 0, True)

        rows = [row(1e-3, 1.0), row(5e-2, 2.0), row(1e-3, 4.0), row(1e-4, 8.0)]
        assert peers.time_to(rows, 1e-2) == 4.0
        assert peers.time_to(rows, 1e-4) == 8.0
        assert peers.time_to(rows, 1e-5) is None

    def test_an_exponent_is_that_of_the_power_law(self):
        size = np.array([2.0, 4.0, 8.0, 16.0])
        assert scaling.exponent(size, 3 * size**1.5) == pytest.approx(1.5)

    def test_the_clock_counts_processor_time_and_memory_of_the_call(self):
        assert clock.seconds(lambda: sum(range(20000)), 0.01) > 0
        assert 8e5 < clock.peak_bytes(lambda: np.zeros(100_000)) < 9e5


class TestVerdicts:
    WAVE = next(case for case in units() if case.group == "moduli")

    def test_a_sound_scene_passes(self):
        assert stability.run(self.WAVE).outcome == "pass"

    def test_a_wrong_truth_fails(self):
        def make():
            scene, exact = self.WAVE.make()
            return scene, dataclasses.replace(exact, half_width=exact.half_width * (1 + 1e-9))

        verdict = stability.run(dataclasses.replace(self.WAVE, make=make))
        assert verdict.outcome == "FAIL" and "above the stated" in verdict.note

    def test_a_known_failure_is_named_with_its_reason(self):
        scene, _ = self.WAVE.make()
        case = dataclasses.replace(
            self.WAVE, make=lambda: (scene, PowerPunch(2)), known="the truth is another scene's"
        )
        verdict = stability.run(case)
        assert verdict.outcome == "known" and verdict.note.endswith(case.known)

    def test_a_scene_whose_truth_takes_too_long_is_not_judged(self):
        def make():
            while True:
                sum(range(1000))

        verdict = stability.run(dataclasses.replace(self.WAVE, make=make), patience=0.05)
        assert verdict.outcome == "not judged" and "given up" in verdict.note

    def test_a_scene_is_judged_no_more_closely_than_its_truth_is_known(self):
        scene, exact = self.WAVE.make()

        @dataclasses.dataclass(frozen=True)
        class Found(Westergaard):
            error: float = 0.0

        told = {f.name: getattr(exact, f.name) for f in dataclasses.fields(exact)}
        told["half_width"] *= 1 + 1e-9
        for error, outcome in ((1e-8, "not judged"), (1e-12, "FAIL")):
            verdict = stability.run(
                dataclasses.replace(
                    self.WAVE, make=lambda error=error: (scene, Found(**told, error=error))
                )
            )
            assert verdict.outcome == outcome

    @pytest.mark.parametrize(("undecided", "outcome"), [(True, "undecided"), (False, "FAIL")])
    def test_merged_zones_are_no_failure_where_the_gap_is_below_rounding_and_the_certificate_says_so(
        self, monkeypatch, undecided, outcome
    ):
        scene, one = self.WAVE.make()
        found = contact.solve(scene)
        said = dataclasses.replace(
            found, certificate=dataclasses.replace(found.certificate, undecided=undecided)
        )
        monkeypatch.setattr(stability, "solve", lambda scene, tol: said)
        hair = 1e-9 * one.half_width
        a, b = one.zones[0]

        class Split(Westergaard):
            zones = property(lambda self: np.array([[a, -hair], [hair, b]]))

        split = Split(**{f.name: getattr(one, f.name) for f in dataclasses.fields(one)})
        case = dataclasses.replace(self.WAVE, make=lambda: (scene, split), condition=1e9, hair=1e-9)
        assert stability.run(case).outcome == outcome
        assert stability.run(dataclasses.replace(case, condition=1.0)).outcome == "FAIL"

    @pytest.mark.slow
    def test_the_matrix_has_every_kind_of_extreme(self):
        assert {case.group for case in extremes.matrix(False)} >= {
            "contact fraction",
            "gap between zones",
            "zones of very different width",
            "heights of very different scale",
            "moduli",
            "lengths",
            "load below a merge",
            "load above a merge",
            "load below full contact",
            "slopes",
            "measured with noise",
            "many equal zones",
        }


class TestRuns:
    def test_the_true_error_is_below_the_stated_one_at_every_tolerance(self):
        for case in (cases.wave(0.4), cases.biquadratic()):
            for row in ours(case, quick=True):
                assert row.error <= row.stated

    def test_the_localized_models_come_nearer_with_every_neighbour(self):
        errors = [
            row.error
            for row in hierarchy(cases.wave(0.4), quick=True)
            if row.method.startswith("localized, m")
        ]
        assert errors == sorted(errors, reverse=True) and errors[0] > 1e-3 > 1e-6 > errors[-1]

    @pytest.mark.slow
    def test_a_bench_writes_tables_csv_and_figures(self, tmp_path, monkeypatch):
        monkeypatch.setattr(run, "suite", lambda quick: [cases.wave(0.4)])
        monkeypatch.setattr(curves, "CURVES", {"a wave": (curves._waves, 5, 5)})
        monkeypatch.setattr(
            scaling,
            "series",
            lambda quick: [("zones, equal", [3, 5, 7], scaling.equal_waves, 1e-6)],
        )
        result = CliRunner().invoke(main, ["bench", "--quick", "--out", str(tmp_path / "out")])
        assert result.exit_code == 0, result.output
        names = {file.name for file in (tmp_path / "out").iterdir()}
        assert names == {
            "precision.csv",
            "precision.png",
            "scaling.csv",
            "scaling.png",
            "precision.md",
            "hierarchy.md",
            "stated.md",
            "scaling.md",
            "machine.md",
            "curves.md",
            "imports.md",
        }
        for name in names:
            if name.endswith(".md"):
                assert re.search(
                    r"^Made at (commit|version) ",
                    (tmp_path / "out" / name).read_text(),
                    re.MULTILINE,
                ), name
        # Progress is reported after each measurement.
        assert "wave 2a/L=0.4: " in result.stderr and "zones, equal, 7: " in result.stderr
        with (tmp_path / "out" / "precision.csv").open() as stream:
            table = list(csv.DictReader(stream))
        assert {row["scene"] for row in table} == {"wave 2a/L=0.4"}
        assert all(
            float(row["error"]) <= float(row["stated"])
            for row in table
            if row["method"] == "contact"
        )

    def test_peers_that_are_not_installed_are_named_with_their_extra(self, tmp_path, monkeypatch):
        # A module that is None in sys.modules cannot be imported.
        monkeypatch.setitem(sys.modules, "tamaas", None)
        monkeypatch.setitem(sys.modules, "ContactMechanics", None)
        result = CliRunner().invoke(main, ["bench", "--peers", "--out", str(tmp_path)])
        assert result.exit_code == 2 and "[peers]'" in result.stderr

    def test_stability_ends_with_3_if_a_scene_fails(self, tmp_path, monkeypatch):
        impossible = dataclasses.replace(
            TestVerdicts.WAVE, make=lambda: (TestVerdicts.WAVE.make()[0], PowerPunch(2))
        )
        monkeypatch.setattr(stability, "matrix", lambda quick: [TestVerdicts.WAVE, impossible])
        result = CliRunner().invoke(main, ["stability", "--out", str(tmp_path)])
        assert result.exit_code == 3 and "1 of 2" in result.stderr
        groups = (tmp_path / "stability.md").read_text()
        assert groups.count("\n| moduli | 1 pass, 1 FAIL | E* = 1e-12 Pa |") == 1
        exceptions = (tmp_path / "stability-exceptions.md").read_text()
        assert exceptions.count("\n| moduli: ") == exceptions.count("| FAIL |") == 1
        with (tmp_path / "stability.csv").open() as stream:
            assert [row["outcome"] for row in csv.DictReader(stream)] == ["pass", "FAIL"]

    def test_a_bar_in_a_cell_does_not_break_a_page_s_table(self):
        assert (
            report.markdown(report.Table("key", "title", ("a", "b"), [("|x|", "1")])).splitlines()[
                -1
            ]
            == "| \\|x\\| | 1 |"
        )


@pytest.mark.parametrize("peer", peers.PEERS, ids=lambda peer: peer.name)
def test_another_code_nears_the_same_contact_as_its_grid_is_refined(peer):
    pytest.importorskip(peer.name)
    case = cases.wave(0.4)
    profile = case.profile

    def mean_error(n):
        x = profile.x0 + profile.period * np.arange(n) / n
        heights = -profile.height(x)
        run, read = peer.prepare(heights - heights.max(), case, 1e-10)
        run()
        return truth.at_places(x, read(), case.exact)[1]

    # The error is largest in the two cells that contain a zone end. With cells of the width h
    # it is of the order sqrt(h) there, so the mean error is of the order h sqrt(h).
    assert mean_error(64) < 3e-3
    assert mean_error(1024) < mean_error(64) / 8


class TestTables:
    NAME = cases.wave(0.4).name

    def run(self, method, seconds, error, setting=1e-4, stated=None):
        return Row(self.NAME, method, setting, seconds, error, 0.1 * error, error, stated, 0, True)

    def test_a_true_error_above_the_stated_one_is_counted(self):
        rows = [self.run("contact", 1e-3, 1e-5, stated=2e-5)]
        assert [row[1] for row in report.stated_table(rows).rows] == ["1 of 1", "1 of 1"]
        rows.append(self.run("contact", 1e-3, 1e-5, stated=0.9e-5))
        rows.append(self.run("contact", 1e-3, 1e-5, stated=1.1e-3))
        assert [row[1] for row in report.stated_table(rows).rows] == ["2 of 3", "2 of 3"]

    def test_a_code_that_never_reaches_an_error_is_listed_with_its_longest_run(self):
        rows = [
            self.run("contact", 1e-3, 1e-12),
            self.run("tamaas", 0.1, 5e-3),
            self.run("tamaas", 0.5, 2e-3),
        ]
        largest, mean = report.peers_tables(rows, ["tamaas"], [self.NAME])
        assert largest.rows == [(self.NAME, "1 ms", "100 ms", "1 ms", "more than 500 ms")]
        assert mean.rows == [(self.NAME, "1 ms", "100 ms", "1 ms", "more than 500 ms")]

    def test_a_tolerance_that_is_not_met_is_marked_and_one_that_was_not_run_is_empty(self):
        row = dataclasses.replace(self.run("contact", 1e-3, 1e-5, stated=2e-5), met=False)
        (found,) = report.precision_table([row]).rows
        assert found == (self.NAME, "1 ms, not met", "1.0e-05", "2.0e-05", "-", "-", "-")


class TestPages:
    def test_a_table_takes_its_place_and_the_rest_of_the_page_stays(self, tmp_path):
        (tmp_path / "another.md").write_text("| new |\n", encoding="utf-8")
        page = "before\n<!-- measured: another -->\nold\n<!-- end -->\n<!-- measured: peers -->\nkept\n<!-- end -->\nafter"
        filled = pages.filled(page, tmp_path)
        assert "| new |" in filled and "old" not in filled and "kept" in filled
        assert filled.startswith("before\n") and filled.endswith("\nafter")
        assert pages.filled(filled, tmp_path) == filled

    def test_a_long_table_is_shown_short_and_kept_in_full_as_csv(self, tmp_path):
        rows = [("a|b", "1", "2.0e+00", "x")]
        table = report.Table("scaling", "", ("series", "zones", "peak memory", "time"), rows)
        (tmp_path / "scaling.md").write_text(
            report.markdown(table) + "\nMade at commit 1.\n", encoding="utf-8"
        )
        docs = tmp_path / "docs"
        docs.mkdir()
        for name in pages.PAGES:
            (docs / name).write_text("<!-- measured: scaling -->\n<!-- end -->\n", encoding="utf-8")
        pages.fill(tmp_path, docs)
        page = (docs / "benchmarks.md").read_text(encoding="utf-8")
        assert "| series | zones | time |" in page and "| a\\|b | 1 | x |" in page
        assert "\n[Full table](tables/scaling.csv). Made at commit 1.\n" in page
        with (docs / "tables" / "scaling.csv").open(encoding="utf-8") as stream:
            assert list(csv.reader(stream)) == [list(table.columns), *map(list, rows)]

    def test_the_hardest_error_that_another_code_reaches_is_shown(self):
        heads = ("scene", *(f"max {e}: {code}" for e in ("1e-02", "1e-03") for code in "ab"))
        rows = [
            ("one", "1 s", "2 s", "3 s", "4 s"),
            ("two", "1 s", "2 s", "3 s", "more than 4 s"),
            ("three", "1 s", "more than 2 s", "3 s", "more than 4 s"),
        ]
        short = shortened.hardest_reached(shortened.Cells(heads, rows, []))
        assert short.columns == ("scene", "error", "a", "b")
        assert [row[1:] for row in short.rows] == [
            ("1e-03", "3 s", "4 s"),
            ("1e-02", "1 s", "2 s"),
            ("1e-02", "1 s", "more than 2 s"),
        ]

    def test_scenes_that_another_code_solves_faster_are_shown(self):
        heads = ("scene", "mean 1e-03: a", "mean 1e-03: b", "mean 1e-04: a", "mean 1e-04: b")
        rows = [
            ("one", "2 ms", "90 µs", "3 ms", "4 s"),
            ("two", "2 ms", "1 s", "3 ms", "4 s"),
            ("three", "2 ms", "more than 1 µs", "3 ms", "4 s"),
        ]
        short = shortened.faster_elsewhere(shortened.Cells(heads, rows, []))
        assert short.rows == [("one", "2 ms", "90 µs")]

    def test_the_slowest_of_the_fast_scenes_is_shown(self):
        rows = [("a", "90 µs"), ("b", "2 ms"), ("c", "95 µs"), ("d", "3 s")]
        short = shortened.slow_scenes(shortened.Cells(("scene", "time"), rows, []))
        assert short.rows == [("b", "2 ms"), ("slowest of 2 below 1 ms: c", "95 µs"), ("d", "3 s")]

    def test_groups_that_pass_and_are_not_stiff_are_left_out(self):
        groups = [
            ("a", "2 pass", "one", "1.0e+00"),
            ("b", "2 pass", "one", "1.0e+02"),
            ("c", "1 pass, 1 FAIL", "one", "1.0e+00"),
            ("d", "1 FAIL", "-", "-"),
        ]
        cells = shortened.Cells(("scenes", "outcome", "worst", "condition"), groups, [])
        assert [row[0] for row in shortened.stiff_groups(cells).rows] == ["b", "c", "d"]

    def test_the_machine_is_one_line(self, tmp_path):
        table = report.Table("machine", "", ("what", ""), [("threads", "1"), ("numpy", "2.4")])
        text = report.markdown(table) + "\nMade at commit 1.\n"
        line = "Measured with threads 1; numpy 2.4. Made at commit 1.\n"
        assert pages.shown("machine", text) == line

    def test_lost_and_changed_scenes_of_the_ablation_are_added(self):
        rows = [("it", "1", "2", "1.20", "1", "4", "1.40", "124 of 127", "1.30")]
        short = shortened.losses(shortened.Cells(ablation.COLUMNS, rows, []))
        assert short.rows == [("it", "3", "1.20", "5", "1.40", "3", "1.30")]

    def test_every_place_in_the_pages_belongs_to_a_table_that_is_made_and_is_filled(
        self, monkeypatch
    ):
        made = {
            "ablation",
            "precision",
            "hierarchy",
            "peers",
            "peers-mean",
            "stated",
            "scaling",
            "machine",
            "stability",
            "curves",
            "imports",
            "self-affine",
            "measured-trace",
            "sampling",
            "kinds-20000",
            "many-intervals",
        }
        named = set()
        for name in pages.PAGES:
            for found in pages.PLACE.finditer((ROOT / "docs" / name).read_text(encoding="utf-8")):
                named.add(found[2])
                assert len(found[0].split()) > 20, f"{found[2]} in {name} is empty"
        assert named == made


class TestAblation:
    @pytest.mark.parametrize("name", ablation.MECHANISMS)
    def test_the_code_that_a_row_switches_off_exists(self, name):
        for switch in ablation.MECHANISMS[name]:
            owner, attribute = switch.find()
            assert switch.off(vars(owner)[attribute]) is not vars(owner)[attribute]

    def test_a_row_whose_target_is_gone_is_an_error(self):
        with pytest.raises(AttributeError, match="outdated"):
            ablation.Switch("sie.slits.slits:gone", ablation.returning(None)).find()
        with pytest.raises(AttributeError, match="outdated"):
            ablation.without("gone")((("one zone", None),))

    def test_lost_and_changed_scenes_are_counted(self):
        zones = [[-1.0, 1.0]]
        one = {"solved": True, "zones": zones, "error": 1e-9, "seconds": 1.0}
        extreme = [{"within": True, "seconds": 2.0}]
        on = {"ordinary": [one, one, one], "large": [one], "extreme": extreme}
        other = one | {"zones": [[-1.0, 1.1]], "seconds": 3.0}
        off = {
            "ordinary": [one | {"solved": False}, other, one | {"seconds": 2.0}],
            "large": [one | {"seconds": 5.0}],
            "extreme": [{"within": False, "seconds": 1.0}],
        }
        found = ablation.row("it", on, off)
        assert found == ("it", "1", "1", "2.50", "0", "0", "5.00", "0 of 1", "0.50")
        only = ablation.row("it", on, off | {"large": [], "extreme": []})
        assert only == ("it", "1", "1", "2.50", "not run", "", "", "not run", "")
