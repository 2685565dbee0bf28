"""Profiles given by heights only: solved as with their slope, or refused for the true reason."""

import numpy as np
import pytest
from scipy.special import j0, j1

import contact
from contact.model.profiles.derive import differences, scale_of
from tests.tiers import diagonal

E_STAR = 1e9
TURN = 2 * np.pi


class Heights(contact.Profile):
    """A profile that is given by its height only."""

    def __init__(self, height, period=None):
        self.height_of, self.length = height, period

    @property
    def period(self):
        return self.length

    def height(self, x):
        return self.height_of(np.asarray(x))


class Given(Heights):
    """The same profile, given by height and slope."""

    def __init__(self, height, slope, period=None):
        super().__init__(height, period)
        self.slope_of = slope

    def slope(self, x):
        return self.slope_of(np.asarray(x, dtype=float))


def of_floats(height):
    """The same height function, but without complex arguments."""
    return lambda x: height(np.asarray(x, dtype=float))


RADIUS, AMPLITUDE, WAVE = 1e-2, 1e-7, 2e-5


def rippled(x):
    return x**2 / (2 * RADIUS) + AMPLITUDE * (1 - np.cos(TURN * x / WAVE))


def rippled_slope(x):
    return x / RADIUS + AMPLITUDE * TURN / WAVE * np.sin(TURN * x / WAVE)


@pytest.mark.parametrize(
    ("pressed", "kind"), diagonal([(1e4, 5), (5e4, 9), (1e6, 21)], ["complex", "floats"])
)
def test_scales_far_apart_are_solved_by_heights_alone(pressed, kind):
    load, zones = pressed
    kind = of_floats if kind == "floats" else lambda height: height
    own, known = Heights(kind(rippled)), Given(rippled, rippled_slope)
    found, told = (
        contact.solve(contact.Scene(p, 1e11, contact.Isolated(), load=load)) for p in (own, known)
    )
    assert len(found.zones) == zones
    assert np.all(
        np.abs(found.zones - told.zones) <= (found.error + told.error) * np.diff(told.zones)
    )


# The height, the slope and the period of each profile.
SHAPES = {
    "catenary": (np.cosh, np.sinh, None),
    "constant": (lambda x: 100 + x**2 / 2, lambda x: x, None),
    "bump far away": (
        lambda x: -0.2 * np.exp(-((x - 300) ** 2)),
        lambda x: 0.4 * (x - 300) * np.exp(-((x - 300) ** 2)),
        None,
    ),
    "hyperbola": (lambda x: np.sqrt(1 + x**2) - 1, lambda x: x / np.sqrt(1 + x**2), None),
    "step": (
        lambda x: 0.05 * np.tanh((x - 0.3) / 0.02) + x**2 / 2,
        lambda x: 2.5 / np.cosh((x - 0.3) / 0.02) ** 2 + x,
        None,
    ),
    "pieces": (
        lambda x: np.where(x > 0.2, (x - 0.2) ** 4, 0) + x**2,
        lambda x: np.where(x > 0.2, 4 * (x - 0.2) ** 3, 0) + 2 * x,
        None,
    ),
    "mixed": (lambda x: x**2 + 0.3 * np.abs(x) * x**2, lambda x: 2 * x + 0.9 * np.abs(x) * x, None),
    "wave": (
        lambda x: 3 + 1e-2 * np.cos(TURN * x) + 1e-3 * np.cos(3 * TURN * x + 0.3),
        lambda x: -TURN * (1e-2 * np.sin(TURN * x) + 3e-3 * np.sin(3 * TURN * x + 0.3)),
        1.0,
    ),
    "sharp wave": (
        lambda x: 1e-2 / (1.02 - np.cos(TURN * x)),
        lambda x: -1e-2 * TURN * np.sin(TURN * x) / (1.02 - np.cos(TURN * x)) ** 2,
        1.0,
    ),
}
LONE = [{"load": 1e2}, {"load": 1e6}]
REPEATED = [
    {"contact_fraction": 0.3},
    {"contact_fraction": 0.97},
    {"contact_fraction": 1.0},
    {"approach": 2e-3},
]


@pytest.mark.parametrize(("shape", "kind"), diagonal(SHAPES, ["complex", "floats"]))
def test_heights_alone_give_the_contact_of_the_slope_on_all_routes(shape, kind):
    height, slope, period = SHAPES[shape]
    kind = of_floats if kind == "floats" else lambda height: height
    for control in LONE if period is None else REPEATED:
        model = contact.Isolated() if period is None else contact.Periodic()
        own, known = Heights(kind(height), period), Given(height, slope, period)
        found, told = (
            contact.solve(contact.Scene(p, E_STAR, model, **control), tol=1e-6)
            for p in (own, known)
        )
        assert found.zones.shape == told.zones.shape
        assert np.all(
            np.abs(found.zones - told.zones) <= 2 * (found.error + told.error) * np.diff(told.zones)
        )
        assert found.load == pytest.approx(told.load, rel=10 * (found.error + told.error))


SPREAD = np.cos(np.pi * (np.arange(400) + 0.5) / 400)
DIFFERENTIATED = {
    "ripples": (rippled, rippled_slope, 4e-5 * SPREAD),
    "ripples and far places": (rippled, rippled_slope, np.append(4e-5 * SPREAD, [0.84, -3.0])),
    "wave at its tip": (lambda x: 1e-6 * (1 - np.cos(x)), lambda x: 1e-6 * np.sin(x), 3 * SPREAD),
    "hidden rounding": (lambda x: np.cosh(x) - 1, np.sinh, 1e-5 * SPREAD),
    "bump far away": (
        lambda x: -np.exp(-((x - 1e3) ** 2)),
        lambda x: 2 * (x - 1e3) * np.exp(-((x - 1e3) ** 2)),
        1e3 + SPREAD,
    ),
    "flat top": (
        lambda x: np.where(np.abs(x) < 0.5, 0, (np.abs(x) - 0.5) ** 2),
        lambda x: np.where(np.abs(x) < 0.5, 0, 2 * (np.abs(x) - 0.5) * np.sign(x)),
        0.7 * SPREAD,
    ),
    "steep step": (
        lambda x: np.tanh(1e3 * (x - 0.3)),
        lambda x: 1e3 / np.cosh(np.minimum(1e3 * np.abs(x - 0.3), 300)) ** 2,
        SPREAD,
    ),
    "corners": (lambda x: np.abs(x), np.sign, SPREAD),
    "Bessel": (lambda x: 1 - j0(x), j1, 5 * SPREAD),
    "nanometres": (
        lambda x: 1e-9 * np.sin(x / 1e-9) ** 2,
        lambda x: np.sin(2 * x / 1e-9),
        2e-9 * SPREAD,
    ),
}


@pytest.mark.parametrize("shape", DIFFERENTIATED)
def test_the_error_of_differences_is_at_most_the_stated_one_at_each_point(shape):
    height, slope, x = DIFFERENTIATED[shape]
    derived, doubt = differences(height, x, scale_of(x))
    off = np.abs(derived - slope(x))
    # Round-off of the exact slope: of its value, and by round-off of its argument.
    rounded = 1e-15 * np.abs(slope(x)) + np.abs(slope(np.nextafter(x, np.inf)) - slope(x))
    assert np.all(off <= doubt + 4 * rounded)
    assert np.median(doubt) <= 1e-5 * np.max(np.abs(slope(x)))


def test_heights_beyond_the_ends_of_a_profile_are_not_evaluated():
    asked = []

    def height(x):
        asked.append((np.min(x), np.max(x)))
        return np.asarray(x) ** 3

    x = np.linspace(0.01, 0.99, 50)
    derived, _ = differences(height, x, scale_of(x), (0.0, 1.0))
    assert np.allclose(derived, 3 * x**2, rtol=1e-10, atol=1e-12)
    assert min(lo for lo, _ in asked) >= 0.0 and max(hi for _, hi in asked) <= 1.0


def test_a_slope_without_the_ripples_is_not_taken_for_rounding_of_the_heights():
    wrong = Given(rippled, lambda x: x / RADIUS)
    with pytest.raises(contact.ContactError) as refused:
        contact.solve(contact.Scene(wrong, 1e11, contact.Isolated(), load=1e4))
    assert "rounded" not in str(refused.value)
    assert "slope disagrees with the height" in str(
        refused.value
    ) or "not an antiderivative" in str(refused.value)


@pytest.mark.slow
@pytest.mark.parametrize(
    "height",
    [
        lambda x: 1e-2 * np.maximum(np.abs((x + 0.5) % 1 - 0.5) - 0.1, 0),
        lambda x: np.interp(
            (x + 0.5) % 1 - 0.5, np.linspace(-0.5, 0.5, 5), 1e-2 * np.array([0, 0.5, 0.2, 0.8, 0])
        ),
    ],
    ids=["truncated tooth", "np.interp"],
)
def test_a_refusal_names_the_corner_that_was_not_declared(height):
    with pytest.raises(
        contact.NotConverged, match="the profile does not declare this jump in `kinks`"
    ):
        contact.solve(
            contact.Scene(Heights(height, 1.0), E_STAR, contact.Periodic(), contact_fraction=0.3)
        )


@pytest.mark.parametrize("lo", [0.2, -0.01, 0.123])
@pytest.mark.parametrize(
    "control", [{"contact_fraction": 0.3}, {"contact_fraction": 0.9}, {"mean_pressure": 1e5}]
)
def test_heights_that_are_nan_somewhere_are_refused_with_the_first_such_position(lo, control):
    def height(x):
        return np.where((x > lo) & (x < lo + 1e-3), np.nan, 1e-3 * (1 - np.cos(TURN * x)))

    with pytest.raises(contact.SceneError, match=r"height\(x\) is nan at x = ") as refused:
        contact.solve(contact.Scene(Heights(height, 1.0), E_STAR, contact.Periodic(), **control))
    assert lo < float(str(refused.value).split("x = ")[1].split(" m")[0]) < lo + 1e-3


def test_heights_that_are_nan_beside_an_isolated_contact_are_refused_with_the_first_such_position():
    lost = Heights(lambda x: np.where((x > 0.2) & (x < 0.3), np.nan, x**2))
    with pytest.raises(contact.OutOfRange, match=r"height\(x\) is nan at x = 0\.2"):
        contact.solve(contact.Scene(lost, E_STAR, contact.Isolated(), load=1e7))


@pytest.mark.parametrize("period", [1.0, None])
def test_heights_that_cannot_be_squared_are_refused_for_that(period):
    huge = Heights(
        (lambda x: 1e200 * np.sin(np.pi * x) ** 2) if period else (lambda x: 1e200 * x**2), period
    )
    model = contact.Periodic() if period else contact.Isolated()
    with pytest.raises(contact.SceneError, match="exceed the range of floating-point numbers"):
        contact.solve(contact.Scene(huge, E_STAR, model, load=1e207))


@pytest.mark.parametrize("unit", [1e-9, 1e-6, 1.0, 1e3])
@pytest.mark.parametrize("load", [1e-6, 1e-2])
def test_walls_that_overflow_a_metre_away_hide_no_contact(unit, load):
    own = Heights(lambda x: unit * 2 * np.sinh(x / unit / 2) ** 2)
    found = contact.solve(contact.Scene(own, E_STAR, contact.Isolated(), load=load * E_STAR * unit))
    exact = contact.solve(
        contact.Scene(
            Heights(lambda x: 2 * np.sinh(x / 2) ** 2),
            E_STAR,
            contact.Isolated(),
            load=load * E_STAR,
        )
    )
    assert np.allclose(found.zones / unit, exact.zones, rtol=0, atol=2e-8 * exact.zones[0, 1])
