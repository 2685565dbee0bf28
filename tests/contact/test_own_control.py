"""User-defined controls, one class each: in scenes, files and curves, and against closed forms."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest

import contact
from contact.model import registry
from contact.model.controls import Held, Quantity
from contact.model.scene_file import read_scene, to_toml

WAVE = contact.Sinusoid(1e-6, 1e-4)
BALL = contact.Parabola(1.0)


@dataclass(frozen=True)
class MeanGap(contact.Control):
    unit = "m"
    falls = True

    def of(self, solution: contact.Solution) -> float:
        assert solution.mean_gap is not None
        return solution.mean_gap


@dataclass(frozen=True)
class Peak(contact.Control):
    unit = "Pa"

    def of(self, solution: contact.Solution) -> float:
        return solution.max_pressure


@dataclass(frozen=True)
class Nanometres(contact.Control):
    """A control that prescribes a quantity of the solver, in nanometres."""

    quantity: Quantity = Quantity.APPROACH
    unit = "nm"

    def held(self, scene: contact.Scene) -> Held:
        return Held(self.quantity, 1e-9 * self.value)


OWN = {"mean_gap": MeanGap, "peak": Peak, "nanometres": Nanometres}


@pytest.fixture(autouse=True)
def known() -> Iterator[None]:
    for name, control in OWN.items():
        contact.register_control(name)(control)
    yield
    for name in OWN:
        registry.CONTROLS.forget(name)


def test_a_given_mean_gap_leads_to_the_contact_that_has_it() -> None:
    # As the load grows, the mean gap of a wave falls from the mean of its heights to 0. It is
    # 1.7e-7 m at about half the load of full contact.
    given = contact.solve(contact.Scene(WAVE, 1e9, contact.Periodic(), mean_pressure=1.5e7))
    assert given.mean_gap is not None
    found = contact.solve(
        contact.Scene(WAVE, 1e9, contact.Periodic(), given=MeanGap(given.mean_gap))
    )
    assert found.certificate.holds and found.error <= 1e-8
    assert (
        abs(found.zones - given.zones).max() <= (found.error + given.error) * given.zone_widths[0]
    )
    assert found.scene.control == ("mean_gap", given.mean_gap)


@pytest.mark.parametrize("value", [1e3, 2e6, 5e7])
def test_a_peak_gives_the_width_of_hertz(value: float) -> None:
    found = contact.solve(contact.Scene(BALL, 1e9, contact.Isolated(), given=Peak(value)))
    half_width = 2 * value / 1e9
    assert found.certificate.holds
    assert abs(found.zones[0, 1] / half_width - 1) <= 2 * found.error <= 2e-8
    assert abs(found.zones[0, 1] / (half_width * (1 + 1e-7)) - 1) > 2 * found.error


def test_several_zones_are_found_by_their_highest_pressure() -> None:
    rng = np.random.default_rng(5)
    rough = contact.Fourier(1e-4, rng.normal(size=6) * 1e-7, rng.normal(size=6) * 1e-7)
    found = contact.solve(contact.Scene(rough, 1e9, contact.Periodic(), given=Peak(4e7)))
    assert len(found.zones) > 1 and found.certificate.holds
    assert abs(found.max_pressure / 4e7 - 1) <= 2 * found.error <= 2e-8


def test_a_registered_control_is_known_by_its_name_in_files_scenes_and_curves() -> None:
    scene = contact.Scene(WAVE, 1e9, contact.Periodic(), given=MeanGap(2e-7))
    assert read_scene(to_toml(scene).encode(), "wave") == scene
    by_load = contact.Scene(WAVE, 1e9, contact.Periodic(), load=1.0)
    assert by_load.under("mean_gap", 2e-7) == scene
    gaps = [solution.mean_gap for solution in contact.solve_many(by_load, [4e-7, 2e-7], "mean_gap")]
    assert gaps == pytest.approx([4e-7, 2e-7], rel=1e-6)
    assert contact.controls()["peak"].unit == "Pa"


def test_unreachable_values_and_laws_with_several_contacts_are_refused() -> None:
    with pytest.raises(contact.OutOfRange, match="mean_gap"):
        contact.solve(contact.Scene(WAVE, 1e9, contact.Periodic(), given=MeanGap(2e-6)))
    with pytest.raises(contact.SceneError, match="several contacts"):
        contact.Scene(BALL, 1e9, contact.Isolated(), law=contact.JKR(0.05), given=Peak(1e5))
    with pytest.raises(contact.SceneError, match="exactly one"):
        contact.Scene(WAVE, 1e9, contact.Periodic(), load=1.0, given=MeanGap(1e-7))
    with pytest.raises(contact.SceneError, match="given"):
        contact.Scene(WAVE, 1e9, contact.Periodic(), given=1e-7)  # type: ignore[arg-type]


TURNED = {"interaction": contact.Isolated(datum=1e-3), "moment": 1e-3}


@pytest.mark.parametrize(
    ("quantity", "named", "others"),
    [
        (Quantity.APPROACH, {"approach": 1e-7}, {"profile": BALL, **TURNED}),
        (Quantity.HALF_WIDTH, {"half_width": 1e-5}, {}),
        (Quantity.WIDTH, {"contact_fraction": 0.4}, {}),
        (Quantity.WIDTH, {"contact_fraction": 1.0}, {}),
    ],
)
def test_a_control_that_prescribes_a_quantity_is_solved_as_the_built_in_control(
    quantity: Quantity, named: dict[str, float], others: dict
) -> None:
    parts = {"profile": WAVE, "E_star": 1e9, "interaction": contact.Periodic(), **others}
    value = next(iter(named.values())) * (1e-4 if quantity is Quantity.WIDTH else 1.0)
    expected, found = (
        contact.Scene(**parts, **named),
        contact.Scene(**parts, given=Nanometres(1e9 * value, quantity)),
    )
    assert [(part.name, part.used, part.reason) for part in contact.plan(found).parts] == [
        (part.name, part.used, part.reason) for part in contact.plan(expected).parts
    ]
    assert contact.solve(found).load == pytest.approx(contact.solve(expected).load, rel=1e-7)


@pytest.mark.parametrize(
    ("quantity", "metres", "told"),
    [
        (Quantity.HALF_WIDTH, 6e-5, "half_width = .* less than half the period"),
        (Quantity.WIDTH, 2e-4, "contact_fraction = .* at most 1"),
    ],
)
def test_the_quantity_that_a_control_prescribes_must_be_possible_in_the_scene(
    quantity: Quantity, metres: float, told: str
) -> None:
    with pytest.raises(contact.SceneError, match=told):
        contact.Scene(WAVE, 1e9, contact.Periodic(), given=Nanometres(1e9 * metres, quantity))


def test_a_model_that_admits_no_contact_fraction_admits_no_width() -> None:
    with pytest.raises(contact.SceneError, match="nanometres = .* localized accepts only"):
        contact.Scene(WAVE, 1e9, contact.Localized(), given=Nanometres(4e4, Quantity.WIDTH))


def test_a_prescribed_approach_needs_a_datum() -> None:
    with pytest.raises(contact.SceneError, match="approach = .* is given a datum"):
        contact.Scene(BALL, 1e9, contact.Isolated(), given=Nanometres(100.0))
