"""Exported data are those of the solution, in full precision and in types every reader has."""

from __future__ import annotations

import csv
import io
import json

import numpy as np
import pytest

import contact
from contact.solution import export
from contact.solution.sampling import positions, window, zones_within
from tests.contact.stand_in import StandIn

L = 1e-4
KEYS = {
    "zones", "load", "tangential_load", "mean_pressure", "max_pressure", "approach", "contact_fraction", "zone_loads", "zone_widths",
    "stiffness", "mean_gap", "tilt", "moment", "rotational_stiffness", "error", "certificate", "plan", "warnings",
    "zone_peaks", "scene", "trace", "units", "version",
}  # fmt: skip


def westergaard(half_width=0.2 * L, waves=1, peak=None) -> StandIn:
    """A stand-in for a solution with `waves` waves in the period, each with a zone."""
    profile = contact.Fourier(L, cosine=[0.0] * (waves - 1) + [-1e-6])
    scene = contact.Scene(profile, E_star=1.1e11, interaction=contact.Periodic(), mean_pressure=1e7)
    return StandIn(scene, 1e-6, half_width / waves, waves, peak)


class TestJSON:
    def test_one_object_has_the_agreed_keys_and_the_values_to_the_last_digit(self):
        solution = westergaard()
        read = json.loads(export.to_json(solution))
        assert set(read) == KEYS
        assert read["load"] == solution.load
        assert read["approach"] == solution.approach
        assert read["zones"] == solution.zones.tolist()
        assert read["load"] != westergaard(0.2001 * L).load

    def test_infinite_and_undefined_values_are_null_at_any_depth(self):
        assert json.loads(export.to_json(westergaard(peak=np.inf)))["max_pressure"] is None
        assert json.loads(export.to_json(westergaard()))["certificate"]["largest_gap"] is None
        assert export.plain({"a": [np.nan, (np.inf, None)], "b": np.array([[1.0, -np.inf]])}) == {
            "a": [None, [None, None]], "b": [[1.0, None]],
        }  # fmt: skip

    def test_full_contact_is_an_empty_list_of_zones(self):
        assert json.loads(export.to_json(westergaard(0.5 * L)))["zones"] == []

    def test_numbers_of_numpy_become_plain_ones(self):
        made = export.plain(
            {"n": np.int64(3), "x": np.float64(0.1), "yes": np.bool_(True), "name": "p", 1: True}
        )
        assert made == {"n": 3, "x": 0.1, "yes": True, "name": "p", "1": True}
        assert [type(value) for value in made.values()] == [int, float, bool, str, bool]


class TestCSV:
    def test_a_row_a_zone_reads_back_to_the_last_digit(self):
        solution = westergaard(waves=5)
        rows = list(csv.DictReader(io.StringIO(export.to_csv(solution))))
        assert tuple(rows[0]) == export.ZONE_COLUMNS
        assert np.array_equal(
            [[float(row["left"]), float(row["right"])] for row in rows], solution.zones
        )
        assert np.array_equal([float(row["load"]) for row in rows], solution.zone_loads)

    def test_width_times_mean_pressure_is_the_load_of_the_zone(self):
        for left, right, width, load, mean_pressure, _ in export.zone_table(westergaard(waves=3)):
            assert width == right - left
            assert width * mean_pressure == pytest.approx(load, rel=1e-15)

    def test_full_contact_is_the_header_alone(self):
        assert export.to_csv(westergaard(0.5 * L)) == ",".join(export.ZONE_COLUMNS) + "\n"

    def test_the_file_holds_the_text(self, tmp_path):
        export.write_csv(westergaard(), tmp_path / "zones.csv")
        assert (tmp_path / "zones.csv").read_text() == export.to_csv(westergaard())


class TestNetCDF:
    def test_zones_and_fields_read_back_as_they_were(self, tmp_path):
        pytest.importorskip("h5py")
        xarray = pytest.importorskip("xarray")
        solution = westergaard(waves=3)
        export.write_netcdf(solution, tmp_path / "out.nc")
        with xarray.open_dataset(tmp_path / "out.nc", engine="h5netcdf") as data:
            assert np.array_equal(data.zones, solution.zones)
            assert np.array_equal(data.zone_load, solution.zone_loads)
            assert np.array_equal(data.pressure, solution.pressure(data.x.values))
            assert data.pressure.units == "Pa"
            assert data.attrs["load"] == solution.load
            assert json.loads(data.attrs["scene"])["control"] == {"mean_pressure": 1e7}

    def test_the_fields_satisfy_u_plus_f_less_approach_is_the_gap(self):
        data = export.to_xarray(westergaard())
        profile = data.profile - float(data.profile.min())
        assert np.allclose(
            data.displacement + profile - data.attrs["approach"], data.gap, rtol=0, atol=1e-20
        )

    def test_a_trapezoid_over_the_sampled_pressure_gives_the_load(self):
        data = export.to_xarray(westergaard())
        load = float(np.trapezoid(data.pressure, data.x))
        # The samples are about a thousandth of the period apart. The trapezoidal rule is wrong
        # by (h^2/12) p'', a relative 1e-6, and by more at the ends of zones.
        assert load == pytest.approx(data.attrs["load"], rel=1e-4)
        assert load != pytest.approx(1.001 * data.attrs["load"], rel=1e-4)

    def test_quantities_that_the_scene_does_not_define_are_left_out(self):
        scene = contact.Scene(
            contact.Parabola(1e-2), E_star=1.1e11, interaction=contact.Isolated(), load=1e3
        )
        attributes = export.to_xarray(contact.solve(scene)).attrs
        assert "mean_pressure" not in attributes and "approach" not in attributes

    def test_a_long_measured_profile_is_described_by_the_shape_of_its_arrays(self):
        x = np.linspace(0.0, L, 500)
        trace = contact.Sampled(x, np.cos(2 * np.pi * x / L), period=L)
        scene = contact.Scene(trace, E_star=1.1e11, interaction=contact.Periodic(), load=1.0)
        told = export.describe(scene)["profile"]
        shape = "array of shape (499,)"
        assert told == {"shape": "sampled", "x": shape, "height": shape, "period": L}


class TestDescription:
    def test_a_described_scene_is_the_tables_of_a_file_that_gives_it_back(self):
        interaction = contact.Localized(closure="self-consistent", neighbours=1)
        scene = contact.Scene(
            contact.Wedge(0.02, L), E_star=1.1e11, interaction=interaction, load=3.0
        )
        assert (
            contact.model.scene_file.scene_from_tables(
                json.loads(json.dumps(export.describe(scene)))
            )
            == scene
        )


class TestSampling:
    def test_positions_ascend_within_the_window_and_hold_every_end(self):
        solution = westergaard(waves=4)
        lo, hi = window(solution)
        x = positions(solution, lo, hi)
        assert (x[0], x[-1]) == (lo, hi) == (-L / 2, L / 2)
        assert np.all(np.diff(x) > 0)
        assert np.isin(zones_within(solution, lo, hi), x).all()

    def test_a_zone_across_the_border_is_cut_in_two_that_make_its_width(self):
        solution = westergaard(waves=4)
        assert len(solution.zones) == 4
        cut = zones_within(solution, *window(solution))
        assert len(cut) == 5
        assert np.diff(cut).sum() == pytest.approx(solution.zone_widths.sum(), rel=1e-12)

    def test_many_periods_hold_the_images_of_the_zones(self):
        assert len(zones_within(westergaard(), -2.5 * L, 2.5 * L)) == 5

    def test_full_contact_is_one_stretch(self):
        assert zones_within(westergaard(0.5 * L), -L / 2, L / 2).tolist() == [[-L / 2, L / 2]]

    def test_an_isolated_zone_is_shown_with_its_width_on_either_side_but_not_beyond_what_was_measured(
        self,
    ):
        scene = contact.Scene(
            contact.Flat(2e-5), E_star=1.1e11, interaction=contact.Isolated(), load=1e3
        )
        assert window(contact.solve(scene)) == pytest.approx((-3e-5, 3e-5), rel=1e-12)
        x = np.linspace(-L, L, 41)
        trace = contact.Sampled(x, -(x**2) / 2e-2)
        # The load is Hertz's for the half width 0.8 L. The width of the zone on either side
        # would leave the trace.
        load = np.pi / 4 * 1.1e11 * (0.8 * L) ** 2 / 1e-2
        wide = contact.Scene(trace, E_star=1.1e11, interaction=contact.Isolated(), load=load)
        assert window(contact.solve(wide)) == (-L, L)
        # A trace is shown whole, also if the zone is narrow.
        lightly = contact.Scene(
            trace, E_star=1.1e11, interaction=contact.Isolated(), load=1e-3 * load
        )
        assert window(contact.solve(lightly)) == (-L, L)
