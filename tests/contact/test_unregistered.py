"""Classes with one method and no registered name serve as parts of a scene. A mistake in such a
class is named in the message.
"""

from __future__ import annotations

import json
import math
import pickle
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import contact
import sie
from contact.explorer.handles import handles, with_values
from contact.model.controls import Held, Quantity
from contact.model.scene_file import to_toml
from contact.sweeps.compare import compare

WAVE, BALL = contact.Sinusoid(1e-6, 1e-4), contact.Parabola(1e-2)
PERIODIC, ISOLATED = contact.Periodic(), contact.Isolated()


@dataclass(frozen=True)
class Coat(contact.Substrate):
    depth: float

    def symbol(self, q):
        return 1 + 0.5 * np.exp(-q * self.depth)


@dataclass(frozen=True)
class Sticky(contact.Law):
    K: float
    pulls = True

    def intensity(self, E_star):
        return -self.K


@dataclass(frozen=True)
class Bed(contact.Interaction):
    eps: float
    needs_period = True

    def symbol(self, q):
        return 1 + self.eps * np.exp(-q * 1e-5)


@dataclass(frozen=True)
class Two(contact.Profile):
    amplitude: float
    period: float

    def height(self, x):
        turns = 2 * np.pi * np.asarray(x) / self.period
        return self.amplitude * (np.cos(turns) + 0.3 * np.cos(2 * turns + 1))


@dataclass(frozen=True)
class Peak(contact.Control):
    unit = "Pa"

    def of(self, solution):
        return solution.max_pressure


@dataclass(frozen=True)
class PeakOver(contact.Control):
    hardness: float

    def of(self, solution):
        return solution.max_pressure / self.hardness


class Plain(contact.Substrate):
    def __init__(self, depth):
        self.depth = depth

    def symbol(self, q):
        return 1 + 0.5 * np.exp(-q * self.depth)


def scene(profile=WAVE, interaction=PERIODIC, **keys) -> contact.Scene:
    return contact.Scene(profile, 1e9, interaction, **keys)


OWN = {
    "substrate": lambda: scene(substrate=Coat(1e-5), contact_fraction=0.5),
    "plain": lambda: scene(substrate=Plain(1e-5), contact_fraction=0.5),
    "law": lambda: scene(BALL, ISOLATED, law=Sticky(1e3), half_width=1e-4),
    "interaction": lambda: scene(interaction=Bed(0.5), contact_fraction=0.5),
    "profile": lambda: scene(Two(1e-6, 1e-4), load=100.0),
    "counter": lambda: scene(contact.Combined(WAVE, Two(1e-6, 1e-4), shift=1e-5), load=100.0),
    "control": lambda: scene(given=Peak(1e6)),
    "parameters": lambda: scene(given=PeakOver(0.01, 1e8)),
}
NAMES = {
    "substrate": "Coat", "plain": "Plain", "law": "Sticky", "interaction": "Bed", "profile": "Two", "counter": "Two",
    "control": "Peak", "parameters": "PeakOver",
}  # fmt: skip


@pytest.mark.parametrize("kind", OWN)
def test_every_use_of_a_scene_works_with_an_unregistered_part(kind: str, tmp_path: Path) -> None:
    given = OWN[kind]()
    solution = contact.solve(given, tol=1e-6)
    assert (
        solution.certificate.holds
        and repr(solution)
        and str(solution.plan)
        and str(contact.plan(given))
    )
    assert NAMES[kind] in json.dumps(solution.to_dict()["scene"])
    for name in ("a.json", "a.nc"):
        solution.save(tmp_path / name)
    solution.save_zones(tmp_path / "zones.csv")
    assert pickle.loads(pickle.dumps(solution)).load == solution.load
    name, value = given.control
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert [
            one.scene.control[1]
            for one in contact.solve_many(given, [value, 1.05 * value], tol=1e-5)
        ] == [value, 1.05 * value]
        table = contact.sweep(
            given,
            {"material.E_star": [1e9, 1.1e9], f"control.{name}": [value]},
            tol=1e-4,
            workers=1,
        )
        assert not table["failed"].values.any()
        assert any(attempt.solution is not None for attempt in compare(given, tol=1e-4))
    known = handles(given, solution)
    assert with_values(given, {known[0].name: 1.01 * value}, known).control == (
        name,
        pytest.approx(1.01 * value),
    )
    with pytest.raises(
        contact.SceneError,
        match=f"{NAMES[kind]}.*registered under a name, for example by contact.register_",
    ):
        to_toml(given)


def test_a_control_without_a_name_keeps_its_other_parameters() -> None:
    given = OWN["parameters"]()
    twice = contact.solve_many(given, [0.01, 0.02], tol=1e-6)
    assert [solution.max_pressure for solution in twice] == pytest.approx([1e6, 2e6], rel=1e-5)


def test_a_class_that_is_derived_from_a_registered_one_has_its_own_name() -> None:
    class Softer(contact.HalfPlane):
        pass

    assert Softer.name == "Softer" and contact.HalfPlane.name == "half-plane"
    with pytest.raises(contact.SceneError, match="register_substrate"):
        to_toml(scene(substrate=Softer(), load=1.0))


def mine(base: type, **body: object) -> type:
    return dataclass(frozen=True)(type("Mine", (base,), body))


def flat(self, q):
    return 1 + 0 * q


def wave(self, x):
    return 1e-6 * np.cos(2 * np.pi * np.asarray(x) / 1e-4)


def peak(self, solution):
    return solution.max_pressure


STRIP = {"needs_period": True, "strip": True}
SUBSTRATES = [
    ({}, "must define symbol"),
    ({"symbol": 2.0}, "substrate.symbol = 2.0 .* method that is called as substrate.symbol\\(q\\)"),
    ({"symbol": lambda self: 1.0}, "takes|argument"),
    ({"symbol": lambda self, q: {}["x"]}, "raises KeyError"),
    ({"symbol": flat, "name": 3}, "substrate.name = 3"),
    ({"symbol": flat, "units": "m"}, "substrate.units = 'm'"),
    ({"symbol": flat, "compression": property(lambda self: 1 / 0)}, "substrate.compression raises ZeroDivisionError"),
]  # fmt: skip
LAWS = [
    ({"intensity": lambda self, E: None}, "law.intensity\\(E_star\\) = None"),
    ({"intensity": lambda self, E: np.zeros(2)}, "law.intensity\\(E_star\\)"),
    ({"intensity": 2.0}, "law.intensity = 2.0"),
    ({"intensity": lambda self: 0.0}, "law.intensity is refused"),
    ({"intensity": lambda self, E: 1 / 0}, "law.intensity\\(E_star\\) raises ZeroDivisionError"),
    ({"intensity": lambda self, E: 1e3}, "at most 0"),
    ({"intensity": lambda self, E: -1e3}, "law.pulls = False"),
    ({"pulls": "yes"}, "law.pulls = 'yes'"),
    ({"allows": "load"}, "law.allows = 'load'"),
    ({"allows": ("fraction",)}, "law.allows"),
    ({"allows": None}, "law.allows = None"),
    ({"refuses": lambda self, scene: True}, "law.refuses\\(scene\\) = True"),
    ({"refuses": lambda self, scene: scene.nothing}, "law.refuses\\(scene\\) raises AttributeError"),
    ({"fault": lambda self, fields, load: 1 / 0}, "law.fault\\(fields, load\\) raises ZeroDivisionError"),
    ({"bare": "frictionless"}, "law.bare = 'frictionless'"),
    ({"tension": 1e3}, "law.reach = 0.0"),
    ({"tension": "1"}, "law.tension = '1'"),
]  # fmt: skip
INTERACTIONS = [
    ({"allows": "load"}, "interaction.allows = 'load'"),
    ({"needs_period": lambda self: True}, "interaction.needs_period"),
    ({"datum": "1"}, "interaction.datum = '1'"),
    ({"datum": -1.0}, "interaction.datum = -1.0"),
    ({"strip": True}, "interaction.needs_period = False"),
    ({**STRIP, "neighbours": 1.5}, "interaction.neighbours = 1.5"),
    ({**STRIP, "side_conditions": lambda self, period: sie.Amplitude(0, 0.0)}, "a tuple of sie.Condition"),
    ({**STRIP, "side_conditions": lambda self, period: None}, "a tuple of sie.Condition"),
    ({**STRIP, "side_conditions": lambda self, period: (sie.Amplitude,)}, "a tuple of sie.Condition"),
    ({**STRIP, "side_conditions": lambda self, period: 1 / 0}, "side_conditions\\(period\\) raises ZeroDivisionError"),
    ({"needs_period": True, "columns": lambda self, period, centre: 1 / 0}, "columns\\(period, centre\\) raises"),
    ({"needs_period": True, "columns": lambda self, period, centre: sie.Forcing(np.ones_like)}, "a tuple of sie.Forcing"),
]  # fmt: skip
PROFILES = [
    ({"height": wave, "name": 3}, "profile.name = 3"),
    ({"height": 1.0}, "profile.height = 1.0"),
    ({"height": wave, "x0": "a"}, "profile.(x0|resolution)"),
    ({"height": wave, "feature": lambda self: 1e-5}, "profile.feature"),
    ({"height": wave, "breakpoints": lambda self: np.zeros(1)}, "profile.breakpoints"),
    ({"height": wave, "exact_places": "no"}, "profile.exact_places = 'no'"),
    ({"height": wave, "slope_conjugate": lambda self, x: 1.0}, "profile.slope_conjugate\\(x\\) = 1.0"),
    ({"height": wave, "slope_conjugate": lambda self, x: 1 / 0}, "profile.slope_conjugate\\(x\\) raises"),
]  # fmt: skip
CONTROLS = [
    ({}, "control.of\\(solution\\)"),
    ({"of": lambda self, solution: None}, "Mine.of\\(solution\\) = None"),
    ({"of": lambda self, solution: np.zeros(2)}, "Mine.of\\(solution\\)"),
    ({"of": lambda self, solution: math.inf}, "Mine.of\\(solution\\) = inf"),
    ({"of": lambda self, solution: 1 / 0}, "Mine.of\\(solution\\) raises ZeroDivisionError"),
    ({"of": 3.0}, "control.of = 3.0"),
    ({"of": peak, "name": "load"}, "control.name = 'load'"),
    ({"of": peak, "unit": None}, "control.unit = None"),
    ({"of": peak, "falls": "yes"}, "control.falls = 'yes'"),
    ({"of": peak, "check": lambda self, scene: 1 / 0}, "control.check\\(scene\\) raises"),
    ({"of": peak, "signed": lambda self, scene: 1 / 0}, "control.signed\\(scene\\) raises"),
    ({"quantity": "load"}, "control.quantity = 'load'"),
    ({"held": lambda self, scene: 1e3}, "control.held\\(scene\\) = 1000.0"),
    ({"held": lambda self, scene: Held("load", 1e3)}, "control.held\\(scene\\)"),  # type: ignore[arg-type]
    ({"held": lambda self, scene: Held(Quantity.LOAD, math.nan)}, "holds load = nan"),
]  # fmt: skip
MISTAKES = [
    *((lambda body=body: scene(substrate=mine(contact.Substrate, **body)(), contact_fraction=0.5), said) for body, said in SUBSTRATES),
    *((lambda body=body: scene(BALL, ISOLATED, law=mine(contact.Law, **body)(), half_width=1e-4), said) for body, said in LAWS),
    *((lambda body=body: scene(interaction=mine(contact.Interaction, **body)(), load=1e3), said) for body, said in INTERACTIONS),
    *((lambda body=body: scene(mine(contact.Profile, period=1e-4, **body)(), contact_fraction=0.5), said) for body, said in PROFILES),
    *((lambda body=body: scene(given=mine(contact.Control, **body)(1e6)), said) for body, said in CONTROLS),
]  # fmt: skip


@pytest.mark.parametrize(("make", "said"), MISTAKES, ids=[said for _, said in MISTAKES])
def test_the_message_names_the_mistake(make, said: str) -> None:
    with pytest.raises(contact.SceneError, match=said):
        contact.solve(make(), tol=1e-4)


def test_a_control_that_cannot_be_made_anew_is_named() -> None:
    class Pressed(contact.Control):
        def __init__(self, pressure: float) -> None:
            object.__setattr__(self, "value", pressure)

        of = peak

    with pytest.raises(
        contact.SceneError, match=r"Pressed\(value=...\) raises TypeError.*frozen dataclass"
    ):
        scene(given=Pressed(1e6))


def test_a_field_that_takes_the_place_of_the_name_is_named() -> None:
    with pytest.raises(contact.SceneError, match="a field of Mine = 'name'"):
        type("Mine", (contact.Profile,), {"__annotations__": {"name": "str"}})


def test_a_tensile_load_under_a_law_without_a_bare_law_is_out_of_range() -> None:
    with pytest.raises(contact.OutOfRange, match="load -10: the law Sticky has no `bare` law"):
        contact.solve(scene(law=Sticky(10.0), load=-10.0))


def test_a_contact_fraction_needs_a_model_that_repeats() -> None:
    with pytest.raises(contact.SceneError, match="contact_fraction.*has no period"):
        scene(interaction=mine(contact.Interaction)(), contact_fraction=0.5)


@dataclass(frozen=True)
class Pair(contact.Interaction):
    """An interaction as on the pages of the documentation. Its kernel contains lambda functions,
    which cannot be pickled.
    """

    depth: float
    allows = ("load",)

    def kernel(self, period, unit):
        h = (self.depth / unit) ** 2
        return sie.cauchy() + sie.Smooth(
            lambda x, y: (x - y) / ((x - y) ** 2 + h), lambda x, y: np.log((x - y) ** 2 + h) / 2
        )


@pytest.mark.slow
def test_solutions_that_cannot_be_pickled_are_computed_in_this_process() -> None:
    loads = [1e3 * (1 + 0.1 * k) for k in range(6)]
    with pytest.warns(RuntimeWarning, match="cannot send solutions back"):
        found = contact.solve_many(scene(BALL, Pair(1e-4), load=1e3), loads, tol=1e-5, workers=2)
    assert [solution.load for solution in found] == pytest.approx(loads)


@pytest.mark.parametrize("tables", [None, {}, {"profile": None}, {"profile": {"scale": 1.0}}])
def test_tables_of_a_profile_that_no_scene_file_holds_are_refused(tables) -> None:
    class Tabled(contact.Profile):
        period = 1.0

        def height(self, x):
            return 1e-3 * np.cos(2 * np.pi * np.asarray(x))

        def tables(self):
            return tables

    with pytest.raises(contact.SceneError, match=r"profile\.tables\(\)"):
        contact.Scene(Tabled(), 1e9, contact.Periodic(), load=1.0)
