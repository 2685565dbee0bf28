"""Whether what a profile returns and declares has the form that the rest of the package counts on.

Looked at once, when a scene is made of a profile of someone's own: a wrong shape is then named, and does not come up as an error of
numpy's in the middle of a solution. Whether the values agree with each other is for `contact.testing.check_profile`.
"""

import warnings
from typing import Any

import numpy as np

from contact.errors import SceneError, shown
from contact.model.checks import of_author, positive_or_none
from contact.model.profiles.base import Profile

# Shapes of what arrays with one row a place must have beyond the first axis.
_TABLES = {"kinks": (2, "position and jump of the slope"), "jumps": (3, "position, order, and jump of that derivative")}
_SPREAD = np.array([[-0.43, -0.21, -0.057], [0.11, 0.29, 0.47]])
_DECADES = np.array([[-0.43, -1.1e-3, -1.3e-9], [1.7e-6, 1.9e-4, 0.29]])


def require_declared(profile: Profile) -> None:
    """SceneError that names the first attribute or method of the profile that has not the form it must have."""
    require_declarations(profile)
    x = _places(profile)
    for name in ("height", "slope"):
        _require_by_elements(profile, name, x)


def require_declarations(profile: Profile) -> None:
    """The same of its attributes alone."""
    positive_or_none("profile.period", _read(profile, "period"))
    for name in ("support", "extent"):
        ends = _read(profile, name)
        if ends is not None and not (_is_real(ends, 1) and np.shape(ends) == (2,) and ends[0] < ends[1]):
            raise SceneError.of(f"profile.{name}", ends, "None, or a left and a larger right end [m]")
    positive_or_none("profile.resolution", _read(profile, "resolution"))
    for name, (columns, meaning) in _TABLES.items():
        table = _read(profile, name)
        if not (isinstance(table, np.ndarray) and _is_real(table, 2) and table.shape[1] == columns):
            allowed = f"a numpy array of finite rows of {columns}: {meaning} (a property, not a method)"
            raise SceneError.of(f"profile.{name}", table, allowed)
    tips = _read(profile, "summits")
    if tips is not None and not (_is_real(tips, 1) and np.size(tips)):
        raise SceneError.of("profile.summits", tips, "None, or a one-dimensional array of positions [m]")
    if not isinstance(symmetric := _read(profile, "symmetric"), (bool, np.bool_)):
        raise SceneError.of("profile.symmetric", symmetric, "True or False (a property, not a method)")


def _read(profile: Profile, name: str) -> Any:
    with of_author(f"profile.{name}", f"profile.{name}"):
        value = getattr(profile, name)
    return value


def _is_real(value: Any, axes: int) -> bool:
    try:
        array = np.asarray(value)
    except ValueError:
        return False
    return array.dtype.kind in "iuf" and array.ndim == axes and bool(np.isfinite(array).all())


def _places(profile: Profile) -> np.ndarray[Any, np.dtype[np.float64]]:
    """A few places (2, 3) at which there should be a profile."""
    ends = profile.known if profile.period is not None else profile.support or profile.extent
    if ends is not None:
        return 0.5 * (ends[0] + ends[1]) + (ends[1] - ends[0]) * _SPREAD
    return (profile.resolution or 1.0) * _DECADES


def _require_by_elements(profile: Profile, name: str, x: np.ndarray[Any, np.dtype[np.float64]]) -> None:
    for given in (x, x.ravel()):
        hint = "; it must work on arrays, element by element (numpy's functions, not math's)"
        with of_author(f"profile.{name}(x)", name, f" for an array of shape {given.shape}", hint), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            value = np.asarray(getattr(profile, name)(given.copy()))
        if value.dtype.kind not in "iuf" or value.shape != given.shape:
            got = f"{shown(value)}, of type {value.dtype} and shape {value.shape}"
            raise SceneError(
                f"profile.{name}(x) for x of shape {given.shape} gives {got}: it must be real and of the shape of x", name, value
            )
        if not (np.isfinite(value) | (np.isposinf(value) & (name == "height"))).any():
            raise SceneError(f"profile.{name}(x) is nowhere a finite number: not at x = {x.ravel().tolist()}", name, value)
