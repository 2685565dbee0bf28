"""`check_profile` finds every way in which a profile can contradict itself, and names it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from contact import Biquadratic, Polynomial, Profile, Sampled, Sinusoid
from contact.testing import ProfileFault, check_profile

L = 2e-4
K = 2 * np.pi / L


class Good(Profile):
    """f = 1e-6 (1 - cos Kx) in the plainest code an author may write."""

    period = L

    def height(self, x):  # type: ignore[no-untyped-def]
        return 1e-6 * (1 - np.cos(K * np.asarray(x)))

    def slope(self, x):  # type: ignore[no-untyped-def]
        return 1e-6 * K * np.sin(K * np.asarray(x))


def variant(**members: object) -> Profile:
    wrapped = {
        k: v if callable(v) or k == "period" else property(lambda self, v=v: v)
        for k, v in members.items()
    }
    made: Profile = type("Variant", (Good,), wrapped)()
    return made


def _bare(profile: Profile) -> Profile:
    """The profile without the jumps that it declares."""
    nothing = {
        "jumps": property(lambda self: np.empty((0, 3))),
        "breakpoints": property(lambda self: np.empty(0)),
    }
    made: Profile = object.__new__(type("Bare", (type(profile),), nothing))
    made.__dict__.update(profile.__dict__)
    return made


def _shouldered() -> Profile:
    """A profile that is flat for |x| <= L/10 and parabolic beyond."""
    beyond = lambda s, x: np.sign(s.wrap(x)) * np.maximum(np.abs(s.wrap(x)) - L / 10, 0)  # noqa: E731
    return variant(
        height=lambda s, x: 100 * beyond(s, x) ** 2,
        slope=lambda s, x: 200 * beyond(s, x),
        kinks=np.array([[-L / 2, -160 * L]]),
    )


_valley = np.array([[-L / 2, -1.0]])

FAULTS = {
    "slope of the wrong sign": (variant(slope=lambda s, x: -Good.slope(s, x)), "slope disagrees"),
    "slope off by a ten-thousandth": (
        variant(slope=lambda s, x: 1.0001 * Good.slope(s, x)),
        "slope disagrees",
    ),
    "period too long": (variant(period=1.1 * L), "not periodic"),
    "slope not periodic": (
        variant(slope=lambda s, x: Good.slope(s, x) + 0 * x + (np.abs(x) > L)),
        "not periodic",
    ),
    "flattened": (variant(height=lambda s, x: np.ravel(Good.height(s, x))), "shape"),
    "depends on its neighbours": (
        variant(height=lambda s, x: Good.height(s, x) - np.min(x)),
        "raises|at the same points",
    ),
    "changes its argument": (variant(slope=lambda s, x: Good.slope(s, _spoil(x))), "changes"),
    "not a number": (
        variant(height=lambda s, x: np.where(np.asarray(x) > 0, Good.height(s, x), np.nan)),
        "finite",
    ),
    "raises": (variant(height=lambda s, x: 1 / 0), "ZeroDivisionError"),
    "complex": (variant(height=lambda s, x: Good.height(s, x) + 0j), "real"),
    "false symmetry": (
        variant(
            height=lambda s, x: 1e-6 * np.sin(K * np.asarray(x)),
            slope=Profile.slope,
            symmetric=True,
        ),
        "symmetric is True, but",
    ),
    "symmetric by word": (variant(symmetric="yes"), "True or False"),
    "kink not declared": (
        variant(height=lambda s, x: np.abs(s.wrap(x)), slope=lambda s, x: np.sign(s.wrap(x))),
        "the profile does not declare this jump in `kinks`",
    ),
    "kink not declared, slope left out": (
        variant(height=lambda s, x: np.abs(s.wrap(x)), slope=Profile.slope),
        "the profile does not declare this jump in `kinks`",
    ),
    "kink declared where there is none": (
        variant(kinks=np.array([[0.1 * L, 0.1]])),
        "kink declared",
    ),
    "kink of the wrong size": (
        variant(
            height=lambda s, x: np.abs(s.wrap(x)),
            slope=lambda s, x: np.where(s.wrap(x) < 0, -1.0, 1.0),
            kinks=np.array([[-L / 2, -2.0], [0, 1.9]]),
        ),
        "kink declared",
    ),
    "kink outside the cell": (variant(kinks=np.array([[L, 0.1]])), "outside the cell"),
    "kinks in one row": (variant(kinks=np.array([0.0, 0.1])), "rows are 2 finite numbers"),
    "a step of the height": (
        variant(height=lambda s, x: Good.height(s, x) + (np.sin(7 * K * np.asarray(x)) > 0) * 1e-7),
        "the height jumps by",
    ),
    "tips that are valleys": (variant(summits=np.array([L / 2 - 1e-9])), "summits"),
    "conjugate of the wrong sign": (
        variant(slope_conjugate=lambda s, x: 1e-6 * K * np.cos(K * np.asarray(x))),
        "slope_conjugate",
    ),
    "jump of the curvature that is not there": (
        variant(jumps=np.array([[0.0, 2, 5.0]])),
        "jumps declares",
    ),
    "jump of the third derivative at the border of the cell": (
        _bare(Biquadratic(1e-3, 4e-5, L)),
        r"derivative 3 .* \[-0.0001, 3, -1.5e\+09\]",
    ),
    "jump of the curvature at the border of the cell": (
        _bare(Polynomial([0, -1.0, 1.0, 1.0], 2.0)),
        r"\[-1, 2, -12\]",
    ),
    "jump at the border, slope left out": (
        variant(height=lambda s, x: s.wrap(x) ** 4 / L**3, slope=Profile.slope, kinks=_valley),
        "derivative 3",
    ),
    "knots of a spline": (
        _bare(Sampled(np.arange(9.0), np.cos(np.arange(9.0)), 9.0)),
        "derivative 3 jumps by .* at 0:",
    ),
    "jump of the curvature within the cell": (_shouldered(), r"\[-2e-05, 2, -200\]"),
    "support that does not end it": (variant(support=(-L / 4, L / 4)), "inf just outside"),
    "negative resolution": (variant(resolution=-1.0), "resolution"),
}


def _spoil(x: np.ndarray) -> np.ndarray:
    kept = np.array(x)
    if isinstance(x, np.ndarray) and x.size:
        x *= 1.0000001
    return kept


@pytest.mark.parametrize("what", FAULTS)
def test_a_fault_is_found_and_named(what: str) -> None:
    profile, message = FAULTS[what]
    with pytest.raises(ProfileFault, match=message) as caught:
        check_profile(profile)
    assert not caught.value.report.ok
    assert str(check_profile(profile, raises=False)) == str(caught.value)


def test_a_good_profile_has_no_fault_and_gets_hints() -> None:
    report = check_profile(Good())
    assert report.ok
    assert any("symmetric" in note for note in report.notes)
    assert any("frozen" in note for note in report.notes)
    assert not check_profile(Sinusoid(1e-6, L)).notes


def test_a_slope_left_out_is_a_hint_and_no_fault() -> None:
    @dataclass(frozen=True)
    class Cosh(Profile):
        scale: float

        def height(self, x):  # type: ignore[no-untyped-def]
            return self.scale * np.cosh(np.asarray(x) / self.scale)

    report = check_profile(Cosh(1e-5))
    assert report.ok and any("differences of heights" in note for note in report.notes)


class ArraysOnly(Good):
    def height(self, x):  # type: ignore[no-untyped-def]
        return super().height(x.copy())

    def slope(self, x):  # type: ignore[no-untyped-def]
        return super().slope(x.copy())


def test_a_profile_that_takes_arrays_only_has_no_fault() -> None:
    report = check_profile(ArraysOnly())
    assert report.ok and any("accepts no number" in note for note in report.notes)


# Correct shapes, tested at several sizes. A bend that looks sharp from afar is not a kink, and
# round-off of heights is not a step.
CORRECT = {
    "catenary": (lambda x: np.cosh(x), np.sinh),
    "hyperbola": (lambda x: np.sqrt(1 + x**2), lambda x: x / np.sqrt(1 + x**2)),
    "soft corner": (lambda x: 0.1 * np.logaddexp(10 * x, -10 * x), lambda x: np.tanh(10 * x)),
    "circle": (lambda x: 1e4 - np.sqrt(1e8 - x**2), lambda x: x / np.sqrt(1e8 - x**2)),
    "constant": (lambda x: 100 + x**2 / 2, lambda x: x),
}


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e3])
@pytest.mark.parametrize("shape", CORRECT)
@pytest.mark.parametrize("given", [True, False])
def test_a_correct_profile_of_any_size_has_no_fault(shape: str, unit: float, given: bool) -> None:
    height, slope = CORRECT[shape]
    members = {
        "height": lambda s, x: unit * height(np.asarray(x) / unit),
        "slope": lambda s, x: slope(np.asarray(x) / unit),
    }
    made = type("Correct", (Profile,), members if given else {"height": members["height"]})()
    report = check_profile(made, raises=False)
    assert report.ok, report


def test_a_kink_that_is_reported_can_be_copied() -> None:
    tooth = type(
        "Tooth", (Profile,), {"height": lambda s, x: np.maximum(np.abs(np.asarray(x)) - 0.1, 0.0)}
    )()
    faults = check_profile(tooth, raises=False).faults
    assert "jumps by 1 at x = -0.1 m," in faults[0] and "jumps by 1 at x = 0.1 m," in faults[1]


def test_an_object_that_is_no_profile_is_refused() -> None:
    with pytest.raises(ProfileFault, match="does not derive"):
        check_profile(np.sin)  # type: ignore[arg-type]
