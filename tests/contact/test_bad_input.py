"""Bad input raises a ContactError, never an error of numpy.

The message names the field, its value, and the values that are allowed.
"""

from __future__ import annotations

import inspect
import warnings

import numpy as np
import pytest

import contact

WAVE, HERTZ = contact.Sinusoid(1e-6, 1e-4), contact.Parabola(1e-2)
PERIODIC, ISOLATED = contact.Periodic(), contact.Isolated()
NAN, INF = float("nan"), float("inf")
NOT_A_NUMBER = [NAN, INF, -INF, True, "1", None, 1j, [1.0], np.array([1.0, 2.0]), object(), 10**400]
NOT_POSITIVE = [0, 0.0, -1.0, *[v for v in NOT_A_NUMBER if v is not None]]
PARTS = [
    contact.Scene,
    *(
        one
        for kind in ("profiles", "interactions", "substrates", "laws", "controls")
        for one in getattr(contact, kind)().values()
    ),
]
CONTROLS = ["load", "mean_pressure", "approach", "half_width", "contact_fraction"]


def in_short(value):
    """The text for a value in the name of a test.

    It must be the same in every process, so it contains no address. A number of four hundred digits
    is abbreviated.
    """
    if type(value) is object:
        return "object"
    return "1e400" if isinstance(value, int) and value > 10**100 else repr(value)


def refused(call, *words):
    """Check that a call raises SceneError with all words, without a warning; return the message."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(contact.SceneError) as caught:
            call()
    for word in words:
        assert word in str(caught.value)
    return str(caught.value)


def scene(profile=WAVE, interaction=PERIODIC, E_star=1.1e11, **control):
    return contact.Scene(profile, E_star, interaction, **(control or {"load": 1.0}))


class TestNumbers:
    @pytest.mark.parametrize("value", NOT_POSITIVE, ids=in_short)
    @pytest.mark.parametrize("control", CONTROLS)
    def test_a_control_is_a_positive_number(self, control, value):
        refused(lambda: scene(**{control: value}), control)

    @pytest.mark.parametrize("value", [*NOT_POSITIVE, None], ids=in_short)
    def test_a_modulus_is_a_positive_number(self, value):
        refused(lambda: scene(E_star=value), "E_star")

    @pytest.mark.parametrize("value", [*NOT_POSITIVE, None], ids=in_short)
    @pytest.mark.parametrize(
        "make, field",
        [
            (lambda v: contact.Sinusoid(v, 1.0), "amplitude"),
            (lambda v: contact.Sinusoid(1.0, v), "period"),
            (lambda v: contact.Wedge(v), "slope"),
            (lambda v: contact.Parabola(v), "radius"),
            (lambda v: contact.Biquadratic(v, 1.0), "radius"),
            (lambda v: contact.Biquadratic(1.0, v), "spacing"),
            (lambda v: contact.Flat(v), "width"),
            (lambda v: contact.Fourier(v, [1.0]), "period"),
        ],
        ids=lambda v: v if isinstance(v, str) else "",
    )
    def test_a_parameter_of_a_profile_is_a_positive_number(self, make, field, value):
        refused(lambda: make(value), field)

    @pytest.mark.parametrize("value", [v for v in NOT_POSITIVE if v is not None], ids=in_short)
    def test_a_period_or_a_datum_if_given_is_a_positive_number(self, value):
        refused(lambda: contact.Wedge(0.1, period=value), "period")
        refused(lambda: contact.Sampled(np.arange(5.0), np.arange(5.0), period=value), "period")
        refused(lambda: contact.Isolated(datum=value), "datum")

    @pytest.mark.parametrize(
        "value", [0, -1e-8, 1.0, 2, 1e-16, NAN, INF, True, "1e-8", None, [1e-8]], ids=repr
    )
    def test_a_tolerance_is_between_rounding_and_one(self, value):
        refused(lambda: contact.solve(scene(), tol=value), "tol")

    @pytest.mark.parametrize("value", [-1, 0.5, "2", True, None, NAN], ids=repr)
    def test_the_number_of_neighbours_is_a_non_negative_integer(self, value):
        refused(lambda: contact.Localized("self-consistent", neighbours=value), "neighbours")


class TestArrays:
    @pytest.mark.parametrize("bad", [NAN, INF, -INF])
    def test_an_array_with_one_value_that_is_no_finite_number_is_refused(self, bad):
        values = np.array([1.0, bad, 3.0, 4.0, 5.0])
        refused(lambda: contact.Polynomial(values), "coefficients")
        refused(lambda: contact.Fourier(1.0, values), "cosine")
        refused(lambda: contact.Fourier(1.0, [1.0], values), "sine")
        refused(lambda: contact.Sampled(np.arange(5.0), values), "height")
        refused(lambda: contact.Sampled(np.array([0.0, 1.0, bad, 3.0, 4.0]), np.ones(5)), "x")

    @pytest.mark.parametrize(
        "bad", ["12345", [], [[1.0, 2.0], [3.0, 4.0]], None, ["a"] * 5, [1j] * 5, {}, 3.0], ids=repr
    )
    def test_anything_but_a_list_of_numbers_is_refused(self, bad):
        refused(lambda: contact.Polynomial(bad), "coefficients")
        refused(lambda: contact.Fourier(1.0, bad))
        refused(lambda: contact.Sampled(bad, np.arange(5.0)), "x")
        refused(lambda: contact.Sampled(np.arange(5.0), bad), "height")

    @pytest.mark.parametrize("x", [[0, 1, 3, 2, 4], [0, 1, 1, 2, 3], [4, 3, 2, 1, 0]])
    def test_positions_that_do_not_increase_are_refused_by_the_first_that_does_not(self, x):
        assert "increasing" in refused(lambda: contact.Sampled(x, [1.0, 2.0, 0.0, 1.0, 3.0]), "x")

    def test_positions_and_heights_of_different_number_are_refused(self):
        refused(lambda: contact.Sampled(np.arange(6.0), np.arange(5.0)), "height")
        refused(lambda: contact.Sampled([0.0, 1.0, 2.0], [0.0, 1.0, 0.0]), "x")

    def test_a_trace_longer_than_its_period_is_refused(self):
        refused(lambda: contact.Sampled(np.arange(6.0), [1.0, 2, 1, 3, 1, 2], period=4.0), "period")

    def test_shapes_that_cannot_touch_are_refused(self):
        refused(lambda: contact.Sampled(np.arange(5.0), np.ones(5)), "height")
        refused(lambda: contact.Polynomial([3.0]), "coefficients")
        refused(lambda: contact.Polynomial([3.0, 0.0, 0.0]), "coefficients")
        refused(lambda: contact.Fourier(1.0, [0.0, 0.0], [0.0]), "cosine")
        refused(lambda: contact.Polynomial([0.0, 1.0], period=1.0), "coefficients")
        refused(lambda: contact.Flat(1.0, period=1.0), "period")
        refused(lambda: contact.Biquadratic(1.0, 1.0, period=0.9), "period")


class TestNames:
    @pytest.mark.parametrize(
        "name, near", [("sinusiod", "sinusoid"), ("Wedge", "wedge"), ("parabolla", "parabola")]
    )
    def test_an_unknown_profile_is_refused_with_the_nearest_one(self, name, near):
        refused(lambda: contact.profile(name), near)

    @pytest.mark.parametrize(
        "name, near",
        [("periodical", "periodic"), ("isolate", "isolated"), ("localised", "localized")],
    )
    def test_an_unknown_interaction_is_refused_with_the_nearest_one(self, name, near):
        refused(lambda: contact.interaction(name), near)

    @pytest.mark.parametrize("name", [None, 3, "", "no such shape at all", ["wedge"]], ids=repr)
    def test_a_value_that_is_no_known_name_is_refused(self, name):
        refused(lambda: contact.profile(name))
        refused(lambda: contact.interaction(name))

    def test_unknown_and_missing_parameters_are_named(self):
        refused(lambda: contact.profile("sinusoid", amplitud=1.0, period=1.0), "amplitud")
        refused(lambda: contact.profile("sinusoid", amplitude=1.0), "period")
        refused(lambda: contact.interaction("localized", closures="first-order"), "closure")

    def test_an_unknown_closure_is_refused_with_those_there_are(self):
        refused(lambda: contact.Localized("second-order"), "first-order", "self-consistent")

    @pytest.mark.parametrize("cls", PARTS, ids=lambda cls: cls.__name__)
    def test_an_argument_that_does_not_exist_is_refused_with_the_nearest(self, cls):
        for name, argument in inspect.signature(cls).parameters.items():
            if argument.kind is not argument.POSITIONAL_ONLY:
                said = refused(
                    lambda name=name: cls(**{name + "s": 1.0}), f"'{name}s' is not known"
                )
                assert f"did you mean '{name}'?" in said
        with pytest.raises(TypeError):  # like Python's own error for an unknown argument
            cls(nonsense=1.0)


class TestScenes:
    def test_exactly_one_control(self):
        message = refused(lambda: contact.Scene(WAVE, 1.0, PERIODIC), "control")
        for name in CONTROLS:
            assert name in message
        refused(lambda: scene(load=1.0, approach=1e-7), "load", "approach")
        refused(lambda: scene(**dict.fromkeys(CONTROLS, 0.5)), "control")

    @pytest.mark.parametrize("thing", [None, "wave", contact.Sinusoid, 3, {}], ids=repr)
    def test_a_profile_is_a_profile(self, thing):
        refused(lambda: scene(profile=thing), "profile")

    @pytest.mark.parametrize("thing", [None, "periodic", contact.Periodic, 3, {}], ids=repr)
    def test_an_interaction_is_an_interaction(self, thing):
        refused(lambda: scene(interaction=thing), "interaction")

    @pytest.mark.parametrize("thing", [None, "scene", WAVE, {}], ids=repr)
    def test_only_a_scene_can_be_solved(self, thing):
        refused(lambda: contact.solve(thing), "scene")

    @pytest.mark.parametrize("model", [PERIODIC, contact.Localized()], ids=lambda m: m.name)
    def test_a_model_that_repeats_needs_a_period(self, model):
        refused(lambda: scene(HERTZ, model), "interaction", "period")

    def test_controls_without_meaning_for_a_scene_are_refused(self):
        refused(lambda: scene(HERTZ, ISOLATED, mean_pressure=1.0), "mean_pressure")
        refused(lambda: scene(HERTZ, ISOLATED, contact_fraction=0.1), "contact_fraction")
        refused(lambda: scene(HERTZ, ISOLATED, approach=1e-6), "approach", "datum")
        refused(lambda: scene(contact_fraction=1.5), "contact_fraction")

    def test_a_half_width_is_of_one_symmetric_zone_within_its_cell(self):
        refused(lambda: scene(half_width=0.5e-4), "half_width")
        refused(lambda: scene(half_width=1.0), "half_width")
        refused(lambda: scene(contact.Fourier(1e-4, [1e-6], [1e-7]), half_width=1e-5), "half_width")
        refused(lambda: scene(contact.Flat(1e-3), ISOLATED, half_width=1e-3), "half_width")

    def test_the_zone_of_a_flat_punch_does_not_determine_the_load(self):
        punch = contact.Flat(0.5, period=1.0)
        refused(lambda: scene(punch, contact_fraction=0.5), "contact_fraction")
        refused(lambda: scene(punch, contact_fraction=0.3), "contact_fraction")
        refused(lambda: scene(punch, half_width=0.25), "half_width")
        refused(
            lambda: scene(punch, contact.Localized("first-order"), load=1.0),
            "interaction",
            "closure",
        )


class TestOutOfRange:
    """Valid scenes for which no contact exists."""

    def out_of_range(self, *words, **given):
        with pytest.raises(contact.OutOfRange) as caught:
            contact.solve(scene(**given))
        for word in words:
            assert word in str(caught.value)

    def test_a_load_past_the_maximum_of_a_closure(self):
        self.out_of_range("first-order", interaction=contact.Localized("first-order"), load=1e9)

    @pytest.mark.parametrize("times", [1.0, 1.001, 1.4, 10.0])
    @pytest.mark.parametrize(
        "profile",
        [
            contact.Sinusoid(1e-6, 1e-4),
            contact.Wedge(0.04, 1e-4),
            contact.Biquadratic(8.5, 0.56, 0.7),
            contact.Sampled([0.0, 0.2, 0.5, 0.7], [0.0, 1e-3, 4e-4, 6e-4], period=1.0),
        ],
        ids=lambda profile: profile.name,
    )
    def test_no_approach_reaches_the_mean_of_the_profile(self, profile, times):
        x = profile.x0 + profile.period * (np.arange(10_000) + 0.5) / 10_000
        height = profile.height(np.append(x, np.asarray(profile.breakpoints)))
        mean = np.mean(height[: len(x)]) - np.min(height)
        approach = times * mean * (1 + 1e-6)
        self.out_of_range("mean of the profile", profile=profile, approach=approach)

    def test_an_approach_past_its_maximum_over_the_datum(self):
        # Hertz: the approach a^2/2R (ln(2d/a) + 1/2) is largest at a = 2d, with the datum d.
        top = (2 * 1e-4) ** 2 / 2e-2 * 0.5
        isolated = contact.Isolated(datum=1e-4)
        solution = contact.solve(scene(HERTZ, isolated, approach=0.999 * top))
        assert solution.zone_widths[0] < 4e-4
        self.out_of_range("approach", profile=HERTZ, interaction=isolated, approach=1.001 * top)

    @pytest.mark.parametrize(
        "coefficients", [[0, 0, -1.0], [0, 1.0], [0, 1.0, 0, -2.0], [1, 0, 1, 0, -1e-3]], ids=repr
    )
    def test_a_polynomial_that_is_unbounded_below(self, coefficients):
        with pytest.raises(contact.ContactError) as caught:
            contact.solve(contact.Scene(contact.Polynomial(coefficients), 1.0, ISOLATED, load=1e3))
        assert isinstance(caught.value, contact.OutOfRange)

    def test_a_zone_at_the_border_of_the_known_profile(self):
        x = np.linspace(0, 1, 21)
        tilted = contact.Sampled(x, x + 0.1 * np.cos(9 * x))
        self.out_of_range("border", profile=tilted, interaction=ISOLATED, E_star=1.0, load=0.1)
        bowl = contact.Fourier(1.0, [0.01])  # its summit lies on the border of the cell
        self.out_of_range("border", profile=bowl, interaction=ISOLATED, E_star=1.0, load=1e-4)

    def test_every_error_is_a_contact_error_and_bad_input_a_value_error(self):
        for kind in (
            contact.SceneError,
            contact.OutOfRange,
            contact.NotConverged,
            contact.MissingExtra,
        ):
            assert issubclass(kind, contact.ContactError)
        assert issubclass(contact.SceneError, ValueError)

    def test_a_tolerance_that_rounding_forbids_is_not_met_in_silence(self):
        # The zone is a millionth of the period wide and far from the origin. Round-off of the
        # positions leaves its ends uncertain by 1e-10 of its width.
        wave = contact.Fourier(1.0, [-0.01, 0.004], [0.003, 0.001])
        with pytest.raises(contact.NotConverged, match="tolerance") as caught:
            contact.solve(contact.Scene(wave, 1.0, PERIODIC, load=1e-12), tol=1e-12)
        assert caught.value.best.error > 1e-12
        assert len(caught.value.trace) > 0
        assert abs(caught.value.best.load / 1e-12 - 1) < 1e-6

    def test_a_masked_number_is_refused_or_unknown_and_a_message_does_not_show_what_it_hides(self):
        with pytest.raises(contact.SceneError, match="amplitude = masked is refused"):
            contact.Sinusoid(np.ma.masked, 1e-4)
        found = contact.solve(contact.Scene(HERTZ, 1e9, ISOLATED, load=1.0))
        pressure = found.pressure(np.ma.array([0.0, 0.0], mask=[False, True]))
        assert pressure[0] == found.max_pressure and np.isnan(pressure[1])
