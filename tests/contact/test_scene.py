"""A scene is a complete contact problem, or it is refused with the name of the wrong argument."""

from __future__ import annotations

import dataclasses
import pickle

import numpy as np
import pytest

import contact

L = 1e-4
WAVE = contact.Sinusoid(amplitude=1e-6, period=L)
HERTZ = contact.Parabola(radius=1e-2)

NOT_A_POSITIVE_NUMBER = [
    0.0, -1.0, float("nan"), float("inf"), -float("inf"), 10**400, True, "2e7", 1j, None, [1.0], np.array([1.0]),
    np.array(1.0), np.bool_(True),
]  # fmt: skip


def scene(**changes):
    given = {"profile": WAVE, "E_star": 1.1e11, "interaction": contact.Periodic()} | changes
    return contact.Scene(**given)


def refused(field: str, **changes) -> str:
    with pytest.raises(contact.SceneError) as caught:
        scene(**changes)
    assert field in str(caught.value)
    return str(caught.value)


class TestEStar:
    def test_two_equal_bodies_halve_the_modulus_of_one_on_a_rigid_body(self):
        rigid = contact.E_star(210e9, 0.3)
        assert rigid == pytest.approx(210e9 / 0.91, rel=1e-15)
        assert contact.E_star(210e9, 0.3, 210e9, 0.3) == pytest.approx(rigid / 2, rel=1e-15)

    def test_compliances_of_unlike_bodies_add_and_the_order_of_the_bodies_does_not_count(self):
        both = contact.E_star(210e9, 0.3, 3e9, 0.4)
        assert 1 / both == pytest.approx(0.91 / 210e9 + 0.84 / 3e9, rel=1e-15)
        assert both == contact.E_star(3e9, 0.4, 210e9, 0.3)

    def test_a_plane_stress_modulus_is_not_taken_for_the_plane_strain_one(self):
        assert abs(contact.E_star(210e9, 0.3) / 210e9 - 1.0) > 0.05

    @pytest.mark.parametrize("nu", [-1.0, 0.500001, 0.6, float("nan"), True, "0.3", None])
    def test_a_poisson_ratio_no_solid_has_is_refused(self, nu):
        with pytest.raises(contact.SceneError, match="nu1"):
            contact.E_star(210e9, nu)

    @pytest.mark.parametrize("modulus", NOT_A_POSITIVE_NUMBER)
    def test_a_modulus_that_is_no_positive_number_is_refused(self, modulus):
        with pytest.raises(contact.SceneError, match="E1"):
            contact.E_star(modulus, 0.3)

    def test_one_constant_of_a_counter_body_is_refused_by_the_missing_one(self):
        with pytest.raises(contact.SceneError, match="nu2"):
            contact.E_star(210e9, 0.3, E2=1e9)
        with pytest.raises(contact.SceneError, match="E2"):
            contact.E_star(210e9, 0.3, nu2=0.3)


class TestControls:
    @pytest.mark.parametrize(
        "name", ["load", "mean_pressure", "approach", "half_width", "contact_fraction"]
    )
    def test_the_control_is_the_quantity_that_was_given(self, name):
        assert scene(**{name: 1e-5}).control == (name, 1e-5)

    def test_a_number_of_numpy_or_an_integer_is_kept_as_a_float(self):
        assert type(scene(load=np.float32(2.0)).load) is float
        assert type(scene(load=np.int64(2)).control[1]) is float
        assert type(scene(E_star=10**11, load=2).E_star) is float

    def test_no_control_and_two_controls_are_refused_and_all_controls_named(self):
        assert "contact_fraction" in refused("control")
        message = refused("control", load=1.0, approach=1e-7)
        assert "load" in message and "approach" in message

    @pytest.mark.parametrize(
        "name", ["load", "mean_pressure", "approach", "half_width", "contact_fraction"]
    )
    @pytest.mark.parametrize("value", [bad for bad in NOT_A_POSITIVE_NUMBER if bad is not None])
    def test_a_control_that_is_no_positive_number_is_refused_by_name(self, name, value):
        refused(name, **{name: value})

    @pytest.mark.parametrize("value", NOT_A_POSITIVE_NUMBER)
    def test_a_modulus_that_is_no_positive_number_is_refused_by_name(self, value):
        refused("E_star", E_star=value, load=1.0)

    def test_controls_are_given_by_name_only(self):
        with pytest.raises(TypeError):
            contact.Scene(WAVE, 1.1e11, contact.Periodic(), 2e7)

    def test_a_contact_fraction_may_be_one_and_no_more(self):
        assert scene(contact_fraction=1).contact_fraction == 1.0
        refused("contact_fraction", contact_fraction=np.nextafter(1.0, 2.0))

    def test_a_contact_fraction_without_a_repeating_surface_is_refused(self):
        refused("contact_fraction", contact_fraction=0.5, interaction=contact.Isolated())

    def test_a_contact_fraction_is_a_control_of_the_periodic_model_only(self):
        refused("contact_fraction", contact_fraction=0.5, interaction=contact.Localized())

    def test_a_mean_pressure_without_a_period_is_refused(self):
        refused("mean_pressure", profile=HERTZ, interaction=contact.Isolated(), mean_pressure=1e6)

    def test_an_approach_of_a_half_plane_needs_a_datum(self):
        assert "datum" in refused("approach", interaction=contact.Isolated(), approach=1e-7)
        assert scene(interaction=contact.Isolated(datum=1e-3), approach=1e-7).approach == 1e-7


class TestPeriod:
    @pytest.mark.parametrize("interaction", [contact.Periodic(), contact.Localized()])
    def test_a_model_that_repeats_refuses_a_profile_that_does_not(self, interaction):
        assert "parabola" in refused(
            "interaction", profile=HERTZ, interaction=interaction, load=1.0
        )

    def test_the_period_is_that_of_the_solution_and_an_isolated_cell_has_none(self):
        assert scene(load=1.0).period == L
        assert scene(load=1.0, interaction=contact.Localized()).period == L
        assert scene(load=1.0, interaction=contact.Isolated()).period is None


class TestHalfWidth:
    def test_it_is_refused_where_the_profile_is_not_known_to_be_symmetric(self):
        skew = contact.Fourier(L, cosine=[-1e-6], sine=[2e-7])
        assert "symmetric" in refused("half_width", profile=skew, half_width=1e-5)

    def test_it_is_refused_from_half_the_period_on(self):
        assert scene(half_width=np.nextafter(L / 2, 0)).half_width < L / 2
        refused("half_width", half_width=L / 2)
        refused("half_width", half_width=L / 2, interaction=contact.Isolated())

    def test_it_is_refused_beyond_the_corners_of_a_flat_punch_and_within_them(self):
        punch = contact.Flat(width=2e-5)
        for half_width in (1.01e-5, 1e-5, 0.5e-5):
            refused(
                "half_width", profile=punch, interaction=contact.Isolated(), half_width=half_width
            )


class TestParts:
    def test_a_class_in_place_of_an_object_is_refused_with_a_hint(self):
        assert "Periodic(...)" in refused("interaction", interaction=contact.Periodic, load=1.0)
        assert "Sinusoid(...)" in refused("profile", profile=contact.Sinusoid, load=1.0)

    @pytest.mark.parametrize("wrong", [None, "periodic", 1.0, {"model": "periodic"}])
    def test_objects_that_are_no_profile_or_interaction_are_refused(self, wrong):
        refused("interaction", interaction=wrong, load=1.0)
        refused("profile", profile=wrong, load=1.0)

    def test_a_scene_does_not_change_and_equal_scenes_are_equal(self):
        one = scene(load=1.0)
        with pytest.raises(dataclasses.FrozenInstanceError):
            one.load = 2.0
        assert one == scene(load=1.0) == pickle.loads(pickle.dumps(one))
        assert one != scene(load=2.0)
        assert hash(one) == hash(scene(load=1.0))

    def test_another_control_replaces_the_previous_one(self):
        one = scene(load=1.0)
        assert dataclasses.replace(one, load=None, mean_pressure=2e7).control == (
            "mean_pressure",
            2e7,
        )
        with pytest.raises(contact.SceneError, match="exactly one"):
            dataclasses.replace(one, mean_pressure=2e7)


def test_under_returns_and_checks_the_scene_with_another_control():
    wave = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Periodic(), mean_pressure=1e6)
    assert wave.under("load", 3.0) == contact.Scene(
        contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Periodic(), load=3.0
    )
    assert wave.mean_pressure == 1e6 and type(wave.under("contact_fraction", 0.25)) is contact.Scene
    for name, value in [
        ("load", -1.0),
        ("contact_fraction", 1.5),
        ("approach", float("nan")),
        ("half_width", 1.0),
    ]:
        with pytest.raises(contact.SceneError, match=name):
            wave.under(name, value)
