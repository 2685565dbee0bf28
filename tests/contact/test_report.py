"""Printed solutions: numbers with units and stated errors, and zones, for each kind of scene."""

from __future__ import annotations

import re

import numpy as np
import pytest

import contact
from contact.axisymmetric import Sphere, solve_spot
from contact.model.units import text_table, with_error
from contact.solution import report

PERIODIC, LONE = contact.Periodic(), contact.Isolated(datum=1.0)
WAVE, CYLINDER = contact.Sinusoid(1e-6, 1e-4), contact.Parabola(0.01)
SERIES = contact.Fourier(1e-4, [0, 0, 1e-7], [2e-7, 0, 1e-7])
E = 1.1e11
DUGDALE = contact.Dugdale(work=0.05, stress=2e6)
SCENES = {
    "closed form": contact.Scene(WAVE, E, PERIODIC, mean_pressure=2e7),
    "zones": contact.Scene(SERIES, E, PERIODIC, load=3e4),
    "gaps": contact.Scene(SERIES, E, PERIODIC, contact_fraction=0.93),
    "full contact": contact.Scene(WAVE, E, PERIODIC, mean_pressure=1e10),
    "infinite pressure": contact.Scene(contact.Wedge(0.05), E, contact.Isolated(), load=2e5),
    "half width": contact.Scene(CYLINDER, E, LONE, half_width=1e-4),
    "approach": contact.Scene(CYLINDER, E, LONE, approach=1e-5),
    "tilt": contact.Scene(contact.Flat(width=1e-3), E, LONE, moment=3.0, load=1e5),
    "localized": contact.Scene(WAVE, E, contact.Localized(), load=3e3),
    "layer": contact.Scene(
        CYLINDER, E, contact.Isolated(), substrate=contact.Layer(1e-4, 0.3), load=1e5
    ),
    "JKR": contact.Scene(WAVE, 1e9, PERIODIC, law=contact.JKR(0.05), mean_pressure=1e4),
    "Dugdale": contact.Scene(
        contact.Parabola(1e-3), 1e9, contact.Isolated(), law=DUGDALE, load=0.0
    ),
    "sliding": contact.Scene(CYLINDER, E, LONE, law=contact.Sliding(0.3, beta=0.2), load=1e5),
    "plastic": contact.Scene(WAVE, E, PERIODIC, law=contact.Plastic(2e9), mean_pressure=3e8),
}
# Words that only the table of this kind of scene contains.
OWN = {
    "full contact": "full contact",
    "infinite pressure": "infinite",
    "tilt": "moment",
    "JKR": "branch",
    "Dugdale": "cohesive intervals",
    "sliding": "tangential load",
    "plastic": "plateaus",
}


@pytest.mark.parametrize("name", SCENES)
def test_a_solution_prints_as_a_table_with_units_and_errors(name):
    solution = contact.solve(SCENES[name])
    lines = str(solution).splitlines()
    assert max(map(len, lines)) <= 80
    rows = {row[0]: row[1:] for row in (re.split(r"\s{2,}", line) for line in lines) if row[0]}
    value, error = rows["load"]
    assert re.fullmatch(r"[\d.]+ k?N/m?m", value) or solution.load == 0
    assert (error == "given") == (SCENES[name].given_load is not None)
    assert rows["stated error"][-1] == f"{solution.error:.2g}"
    assert OWN.get(name, "largest pressure") in str(solution)
    assert "None" not in str(solution) and "nan" not in str(solution)


def test_the_widest_of_many_zones_are_printed():
    waves = contact.Fourier(1e-4, cosine=[1e-8] + [0] * 28 + [1e-8])
    solution = contact.solve(contact.Scene(waves, E, PERIODIC, mean_pressure=1e7))
    count = len(solution.zones)
    columns = dict(report.zone_columns(solution, 4))
    shown = [int(place) for place in columns["zone"]]
    assert count > 10 and shown == sorted(np.argsort(-solution.zone_widths, kind="stable")[:4])
    assert f"the 10 widest zones; {count - 10} more" in str(solution)


def test_zones_have_one_number_in_every_table_and_widths_all_their_digits():
    solution = contact.solve(SCENES["zones"])
    frame, columns = solution.zone_table(), dict(report.zone_columns(solution))
    assert frame.index.name == "zone"
    assert list(frame.index) == [int(place) for place in columns["zone"]]
    for table in (frame, frame.head(), frame[frame["load"] > 0]):
        assert all(f"{width:.6g}" in str(table) for width in solution.zone_widths)
        assert all(f"{width:.6g}" in table._repr_html_() for width in solution.zone_widths)


def test_separated_surfaces_are_printed_as_apart():
    path = contact.path(SCENES["JKR"], [-50.0, 100.0, -2000.0])
    assert str(path).count("apart") == 4 and "infinite" not in str(path) + str(path.solutions[0])


def test_columns_that_are_compared_share_a_unit():
    """The ends of the zone are 0.84 mm and 1.16 mm; the mean pressure is 0.8 MPa, the largest 1.03."""
    shape = contact.Fourier(2e-3, (1e-7,))
    scene = contact.Scene(shape, 1.3e10, PERIODIC, mean_pressure=1.3e5)
    solution = contact.solve(scene)
    assert solution.zones[0, 0] < 1e-3 < solution.zones[0, 1]
    assert solution.load / solution.zone_widths[0] < 1e6 < solution.max_pressure
    units = {name.replace("\n", " "): cells for name, cells in report.zone_columns(solution)}
    assert {"left [mm]", "right [mm]", "mean pressure [MPa]"} <= units.keys()
    assert "largest pressure [MPa]" in units


def test_slips_and_round_spots_print_as_tables():
    rest = contact.solve(SCENES["approach"])
    slip = str(contact.partial_slip(rest, 0.3, 0.15 * rest.load))
    assert re.search(r"stick zones +1, [\d.]+ µm in total\n", slip) and "lost energy" in slip
    assert re.search(r"\nstick +-", slip) and max(map(len, slip.splitlines())) <= 80
    rolls = str(contact.rolling(rest, 0.3, 0.15 * rest.load))
    assert re.search(r"creepage +0.0\d+ ", rolls) and "shift" not in rolls
    spot = str(solve_spot(Sphere(radius=1e-3), 1e11, load=1.0))
    assert re.search(r"load +1 N +[\de.-]+ N\n", spot)


def test_values_have_the_digits_that_their_errors_allow():
    assert with_error(np.pi * 1e6, 1e2, "Pa") == ("3.14159 MPa", "0.0001 MPa")
    assert with_error(np.inf, None, "Pa") == ("infinite", "-")
    assert with_error(-2.0, 0.0, "N/m") == ("-2 N/m", "exact")


def test_a_count_of_one_has_a_noun_in_the_singular():
    for name, scene in SCENES.items():
        words = str(contact.solve(scene).plan)
        assert not re.search(r"\b1 \w+s\b(?! than)", words), name


def test_a_text_table_aligns_words_left_and_numbers_right():
    table = text_table([("name\nof it", ["a", "long"]), ("value", ["1", "100"])])
    assert table == "name   value\nof it\na          1\nlong     100"


def test_a_plan_parts_a_reason_from_its_detail():
    plan = contact.solve(SCENES["zones"]).plan
    lines = str(plan).splitlines()
    for part, line in zip(plan.parts, lines[: len(plan.parts)], strict=True):
        assert line.endswith(f"{part.reason}; {part.detail}" if part.detail else part.reason)
    assert any(part.detail for part in plan.parts)


@pytest.mark.parametrize("name", ["closed form", "zones", "half width", "JKR"])
def test_derivatives_name_their_scene_its_control_and_their_numbers(name):
    by = contact.sensitivity(contact.solve(SCENES[name]))
    text, (control, _) = repr(by), by.solution.scene.control
    assert report.title(by.solution.scene) in text and report.label(control) in text
    assert all(key in text for key in by.keys) and "max_pressure" in text
    assert ("mean_pressure" in text) == (by.solution.mean_pressure is not None)
