"""Laws of contact: made by name, used by solver and certificate, and refused by wrong scenes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

import contact
from contact.closed.fields import ClosedFields
from contact.formulation.fields import ZoneFields
from contact.formulation.full_contact import FullFields
from contact.formulation.gaps import GapFields
from contact.model import registry
from contact.model.laws.base import PressureRange

WAVE = contact.Sinusoid(0.01, 1.0)
SCENE = contact.Scene(WAVE, 1.0, contact.Periodic(), mean_pressure=0.01)


@dataclass(frozen=True)
class Glued(contact.Law):
    """A law that prescribes the edge intensity -K [Pa m^(1/2)] of every end.

    Its own check names the edge intensities if they differ from -K.
    """

    K: float = 0.0
    name = "glued"
    allows = ("load", "mean_pressure", "half_width")
    pulls = True

    def intensity(self, E_star):
        return -self.K

    def refuses(self, scene):
        return "is for periodic scenes" if scene.period is None else None

    def fault(self, fields, load):
        units = fields.problem.units
        found = np.concatenate(fields.density.intensities) * units.intensity
        return (
            "" if np.allclose(found, -self.K, rtol=1e-9, atol=1e-12) else f"K = {found} at the ends"
        )


@pytest.fixture
def registered():
    contact.register_law("test-glued")(Glued)
    yield
    registry.LAWS.forget("test-glued")
    Glued.name = "glued"


def test_a_registered_law_is_made_by_name_and_listed(registered):
    assert contact.law("test-glued", K=1e-3) == Glued(1e-3)
    assert {"frictionless", "test-glued"} <= set(contact.laws())
    with pytest.raises(contact.SceneError, match="did you mean 'frictionless'"):
        contact.law("frictionles")


def test_a_scene_file_names_a_registered_law(registered, tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(
        '[profile]\nshape = "sinusoid"\namplitude = 0.01\nperiod = 1.0\n[material]\nE_star = 1.0\n[interaction]\nmodel = "periodic"\n'
        '[law]\nmodel = "test-glued"\nK = 1e-3\n[control]\nhalf_width = 0.2\n'
    )
    assert contact.load_scene(path).law == Glued(1e-3)


@pytest.mark.parametrize("K", [0.0, 1e-3])
def test_the_ends_of_the_zones_have_the_intensity_that_the_law_prescribes(K):
    # Johnson (1995): pbar = p* sin^2 A - K sqrt(2 pi tan A / L), with K = sqrt(E* w / pi).
    a = 0.2
    solution = contact.solve(replace(SCENE, mean_pressure=None, half_width=a, law=Glued(K)))
    A = np.pi * a
    expected = 0.01 * np.pi * np.sin(A) ** 2 - K * np.sqrt(2 * np.pi * np.tan(A))
    assert solution.mean_pressure == pytest.approx(expected, rel=1e-10)
    assert solution.certificate.holds
    d = 1e-10
    assert solution.pressure(a - d) * np.sqrt(d) == pytest.approx(-K, rel=1e-4, abs=1e-6)


def test_the_check_of_the_law_decides_whether_the_certificate_holds():
    broken = type("Broken", (Glued,), {"fault": lambda self, fields, load: "never right"})
    with pytest.raises(contact.ContactError):
        contact.solve(replace(SCENE, mean_pressure=None, half_width=0.2, law=broken(1e-3)))


def test_scenes_that_the_law_does_not_allow_are_refused_before_any_arithmetic():
    with pytest.raises(contact.SceneError, match="glued accepts only the controls load"):
        replace(SCENE, law=Glued(), mean_pressure=None, approach=1e-3)
    with pytest.raises(contact.SceneError, match="glued is for periodic scenes"):
        contact.Scene(contact.Parabola(1.0), 1.0, contact.Isolated(), law=Glued(), load=0.1)
    with pytest.raises(contact.SceneError, match="solved only for bodies that do not tilt"):
        contact.Scene(
            contact.Parabola(1.0),
            1.0,
            contact.Isolated(),
            law=type("On", (Glued,), {"refuses": lambda *_: None})(),
            load=0.1,
            tilt=0.01,
        )
    with pytest.raises(contact.SceneError, match="no path is computed under other laws"):
        contact.path(replace(SCENE, law=Glued()), [0.01, 0.02])


@pytest.mark.parametrize("wrong", [None, 3, Glued, "frictionless"])
def test_a_value_that_is_no_law_is_refused(wrong):
    with pytest.raises(contact.SceneError, match="law = "):
        replace(SCENE, law=wrong)


def test_frictionless_under_another_name_is_the_same_contact():
    other = type("Smooth", (contact.Frictionless,), {"name": "smooth"})()
    assert np.array_equal(
        contact.solve(replace(SCENE, law=other)).zones, contact.solve(SCENE).zones
    )


@dataclass(frozen=True)
class Capped(contact.Frictionless):
    """Frictionless, for bodies that bear no more than a largest pressure [Pa]."""

    highest: float = 1.0
    name = "capped"

    @property
    def pressure_range(self):
        return PressureRange(highest=self.highest)


class Objecting(contact.Frictionless):
    """Frictionless, with a check of its own that never passes."""

    name = "objecting"

    def fault(self, fields, load):
        return "never right"


ROUGH = contact.Fourier(1.0, [-0.01, 0.004], [0.003, -0.002])
ALONE = contact.Scene(contact.Parabola(1.0), 1.0, contact.Isolated(), load=0.01)
# For each route: a scene, and the class of the fields if the law has no check, and if it has one.
ROUTES = {
    "one zone": (SCENE, ClosedFields, ZoneFields),
    "one zone alone": (ALONE, ClosedFields, ZoneFields),
    "a grid": (replace(SCENE, profile=ROUGH), ZoneFields, ZoneFields),
    "gaps": (replace(SCENE, profile=ROUGH, mean_pressure=0.04), GapFields, GapFields),
    "full contact": (replace(SCENE, profile=ROUGH, mean_pressure=0.2), FullFields, FullFields),
    "a tilt": (replace(ALONE, tilt=0.01), ZoneFields, ZoneFields),
    "a strip": (
        replace(SCENE, interaction=contact.Localized("self-consistent")),
        ZoneFields,
        ZoneFields,
    ),
}


@pytest.mark.parametrize("route", ROUTES)
def test_every_route_asks_the_law_for_its_checks(route):
    scene, plainly, checked = ROUTES[route]
    plain = contact.solve(scene)
    assert type(plain.fields) is plainly
    within = contact.solve(replace(scene, law=Capped(1.001 * plain.max_pressure)))
    assert within.certificate.holds and type(within.fields) is checked
    assert within.zones == pytest.approx(plain.zones, abs=10 * (plain.error + within.error))
    for law, reason in (
        (Capped(0.999 * plain.max_pressure), "above"),
        (Objecting(), "never right"),
    ):
        with pytest.raises(contact.NotConverged, match=reason) as failed:
            contact.solve(replace(scene, law=law))
        best = failed.value.best
        assert best.zones == pytest.approx(within.zones) and not best.certificate.holds


def test_the_loads_of_a_curve_ask_the_law_for_its_checks():
    values = [0.01, 0.02]
    highest = max(one.max_pressure for one in contact.solve_many(SCENE, values))
    within = replace(SCENE, law=Capped(1.001 * highest))
    assert all(one.certificate.holds for one in contact.solve_many(within, values))
    with pytest.raises(contact.NotConverged, match="capped: the pressure reaches"):
        contact.solve_many(replace(SCENE, law=Capped(0.999 * highest)), values)
