"""Unusual arguments of public functions: each gives the right answer, or a named error.

The error says what to change.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cosh

import numpy as np
import pytest

import contact
from tests.tiers import quick

# The shapes are as steep and the loads as high as the arithmetic allows, so warnings about the
# model are ignored.
pytestmark = pytest.mark.filterwarnings("error", "ignore::contact.ModelWarning")
WAVE = contact.Sinusoid(1e-6, 1e-4)
SCENE = contact.Scene(WAVE, 1e9, contact.Periodic(), load=100.0)


def squared(x):
    return 0.5 * np.asarray(x, dtype=float) ** 2


def own(**said):
    """A profile of a new class with these attributes, and these functions of x as methods."""
    parts = {
        name: (lambda self, x, f=value: f(x)) if callable(value) else value
        for name, value in said.items()
    }
    return dataclass(frozen=True)(
        type("Own", (contact.Profile,), {"height": lambda self, x: squared(x), **parts})
    )()


def scene(profile, model=None):
    return contact.Scene(profile, 1e3, model or contact.Isolated(), load=1.0)


FORMS = {
    "a height without shape": (
        {"height": lambda x: 1.0},
        r"height\(x\) .* must be real and of the shape of x",
    ),
    "a slope without shape": ({"slope": lambda x: 1.0}, r"slope\(x\) .* of the shape of x"),
    "a flattened height": (
        {"height": lambda x: squared(x).ravel()},
        r"height\(x\) .* of the shape of x",
    ),
    "an extra axis": (
        {"slope": lambda x: np.asarray(x)[..., None]},
        r"slope\(x\) .* of the shape of x",
    ),
    "nothing": ({"height": lambda x: None}, r"height\(x\) .* must be real"),
    "complex heights": ({"height": lambda x: squared(x) + 0j}, r"height\(x\) .* must be real"),
    "a function of one number": (
        {"height": lambda x: cosh(x)},
        r"height\(x\) raises TypeError .*numpy's functions",
    ),
    "an error": ({"height": lambda x: 1 / 0}, r"height\(x\) raises ZeroDivisionError"),
    "no numbers": (
        {"height": lambda x: np.asarray(x) * np.nan},
        r"height\(x\) is not finite at any of the places x = ",
    ),
    "a list of kinks": (
        {"kinks": [[0.0, 2.0]]},
        "kinks .* a numpy array whose rows are 2 finite numbers",
    ),
    "one kink": ({"kinks": np.array([0.0, 2.0])}, "kinks .* a numpy array whose rows are 2 finite"),
    "no resolution": ({"resolution": 0.0}, "resolution .* > 0"),
    "a negative period": ({"period": -2.0}, "period .* > 0"),
    "a period in words": ({"period": "2"}, "period .* > 0"),
    "a reversed support": ({"support": (1.0, -1.0)}, "support .* a left and a larger right end"),
    "a support of one end": ({"support": 1.0}, "support .* a left and a larger right end"),
    "jumps without order": ({"jumps": np.zeros((2, 2))}, "jumps .* rows are 3 finite numbers"),
    "tips in a table": ({"summits": np.zeros((2, 2))}, "summits .* one-dimensional"),
    "a symmetry in words": ({"symmetric": "yes"}, "symmetric .* True or False"),
}


@pytest.mark.parametrize(("said", "message"), FORMS.values(), ids=FORMS)
def test_a_profile_of_the_wrong_form_is_refused_by_the_name_of_the_wrong_part(said, message):
    with pytest.raises(contact.SceneError, match=message):
        scene(own(**said))


def test_a_profile_of_the_right_form_is_solved():
    assert contact.solve(scene(own(summits=[0.0]))).max_pressure == pytest.approx(
        1e3 * 0.5 * np.sqrt(4 / (np.pi * 1e3))
    )


@pytest.mark.parametrize(
    ("said", "fault"),
    [
        ({"slope": lambda x: 3 * np.asarray(x)}, "slope disagrees with the height"),
        (
            {"height": np.abs, "slope": np.sign},
            "jumps by 2 at x = 0 m, but the profile does not declare this jump in `kinks`",
        ),
        (
            {"height": np.abs, "slope": np.sign, "kinks": np.array([[0.0, 1.0]])},
            "the slope jumps by 2 there",
        ),
    ],
    ids=["slope", "kink", "jump"],
)
def test_a_profile_that_contradicts_itself_is_refused_with_the_contradiction(said, fault):
    with pytest.raises(contact.ContactError, match=fault):
        contact.solve(scene(own(**said)))


@pytest.mark.parametrize("size", quick([1e-6, 1e-7, 1e-8], [1e-7]))
def test_heights_lost_in_round_off_are_refused_and_solved_in_another_form(size):
    load = np.pi * 1e9 * size**2 / 4

    def solved(height):
        profile = own(height=height, slope=lambda x: np.sinh(np.asarray(x)))
        return contact.solve(contact.Scene(profile, 1e9, contact.Isolated(), load=load))

    with pytest.raises(
        contact.SceneError, match="heights of the profile vary by .* are rounded to about .* left"
    ):
        solved(lambda x: np.cosh(np.asarray(x)) - 1)
    kept = solved(lambda x: 2 * np.sinh(0.5 * np.asarray(x)) ** 2)
    assert abs(kept.zones[0, 1] / size - 1) < 1e-9 and kept.certificate.holds


@pytest.mark.parametrize("field", ["pressure", "gap", "displacement"])
@pytest.mark.parametrize("x", ["a", None, 1j, [1, [2, 3]], [True, False]], ids=str)
def test_fields_at_positions_that_are_no_real_numbers_are_refused(field, x):
    with pytest.raises(contact.SceneError, match="real numbers in an array of any shape"):
        getattr(contact.solve(SCENE), field)(x)


@pytest.mark.parametrize("field", ["pressure", "gap", "displacement"])
def test_fields_at_nan_and_infinite_positions_are_nan(field):
    value = getattr(contact.solve(SCENE), field)([0.0, np.nan, np.inf])
    assert np.isfinite(value[0]) and np.isnan(value[1:]).all()


def test_wrong_zones_and_wrong_positions_in_zones_are_refused_by_name():
    solution = contact.solve(SCENE)
    full = contact.solve(contact.Scene(WAVE, 1e9, contact.Periodic(), mean_pressure=1e12))
    for ask, message in (
        (lambda: solution.pressure_at(0.5, 5), "zone = 5 .* the solution has 1 zone"),
        (lambda: solution.pressure_at(0.5, 0.0), "zone = 0.0 .* whole number"),
        (lambda: solution.pressure_at([0.0, 1.5]), "t = .* from -1 to 1"),
        (
            lambda: full.pressure_at(0.5),
            r"in full contact or with the surfaces apart there are no zones: use pressure\(x\)",
        ),
    ):
        with pytest.raises(contact.SceneError, match=message):
            ask()


def test_arguments_that_are_no_scene_or_no_solution_are_refused_by_name():
    for ask, message in (
        (lambda: contact.plan(WAVE), "a contact.Scene"),
        (lambda: contact.solve(SCENE, near="zones"), "near = 'zones' .* a contact.Solution"),
    ):
        with pytest.raises(contact.SceneError, match=message):
            ask()


def test_a_load_too_small_for_the_range_of_numbers_is_out_of_range():
    with pytest.raises(contact.OutOfRange, match="outside the range of floating-point numbers"):
        contact.solve(contact.Scene(WAVE, 1e9, contact.Periodic(), load=5e-324))


def dip(size, at=0.0):
    """The profile (size/10) (1 - exp(-((x - at)/size)^2)), a tenth as deep as it is wide."""
    return own(height=lambda x: -0.1 * size * np.expm1(-(((np.asarray(x) - at) / size) ** 2)))


@pytest.mark.parametrize("size", [1e-8, 1e-5, 1e-2, 10.0, 1e4])
def test_an_asperity_of_unknown_size_that_levels_off_is_found_whatever_its_size(size):
    load = 1e-4 * size
    found, unit = (
        contact.solve(contact.Scene(dip(s), 1.0, contact.Isolated(), load=load / size * s))
        for s in (size, 1.0)
    )
    assert np.allclose(found.zones / size, unit.zones, rtol=0, atol=1e-9 * np.diff(unit.zones))
    # The load is so light that Hertz's solution holds, with R = size^2/(2 depth) = 5 size.
    assert found.zones[0, 1] == pytest.approx(np.sqrt(20 * load * size / np.pi), rel=1e-3)
    assert contact.solve(
        contact.Scene(dip(size, 10 * size), 1.0, contact.Isolated(), load=load)
    ).zones.mean() == pytest.approx(10 * size)


def test_a_derived_slope_does_not_depend_on_the_other_positions_of_the_call():
    profile, x = dip(1e-5), np.array([-3e-6, 1e-7, 8e-6])
    wide = np.append(x, [1.0, -1e12])
    assert np.allclose(profile.slope(wide)[:3], profile.slope(x), rtol=1e-8, atol=0)
    assert np.allclose(
        profile.slope(x), 0.2 * x / 1e-5 * np.exp(-((x / 1e-5) ** 2)), rtol=1e-8, atol=0
    )


def test_the_derived_slope_of_a_periodic_shape_is_checked_once():
    counted = []

    def height(x):
        counted.append(np.size(x))
        return np.exp(np.sin(2 * np.pi * np.asarray(x)))

    wave, x = own(height=height, period=1.0), np.linspace(-0.5, 0.5, 1000)
    for _ in range(20):
        slope = wave.slope(x)
    assert np.allclose(
        slope,
        2 * np.pi * np.cos(2 * np.pi * x) * np.exp(np.sin(2 * np.pi * x)),
        rtol=1e-13,
        atol=1e-13,
    )
    assert sum(counted) < 100_000


@pytest.mark.parametrize("width", [0.3, 0.03])
def test_if_a_height_drops_the_imaginary_part_its_slope_comes_from_differences(width):
    def height(x):
        x = np.asarray(x)
        return np.cos(2 * np.pi * x) + 0.1 * np.where(
            np.abs(x.real) < width, (1 - (x.real / width) ** 2) ** 4, 0.0
        )

    x = width * np.linspace(-0.9, 0.9, 50)
    slope = -2 * np.pi * np.sin(2 * np.pi * x) - 0.8 * x / width**2 * (1 - (x / width) ** 2) ** 3
    assert np.allclose(own(height=height, period=1.0).slope(x), slope, rtol=0, atol=1e-7 / width)


def test_heights_that_overflow_far_away_hide_no_tip():
    catenary = own(height=lambda x: 2e-3 * np.sinh(np.asarray(x) / 2e-3) ** 2)
    with np.errstate(over="ignore"):
        found = contact.solve(contact.Scene(catenary, 1e11, contact.Isolated(), load=1.0))
    assert found.zones[0, 1] == pytest.approx(np.sqrt(4 * 1e-3 / (np.pi * 1e11)))
