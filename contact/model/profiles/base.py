"""The base class of profiles: the gap f(x) at zero load, its slope, and what else is known of it.

Only `height` must be given. f grows away from contact, as for a punch that points down; a constant
offset changes neither zones nor pressures. A periodic profile repeats the cell [x0, x0 + L).
"""

import dataclasses
import inspect
import math
from collections.abc import Mapping
from functools import cached_property
from operator import attrgetter
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

import sie
from contact.model.profiles.derive import DETAIL, DIFFERENCES, DerivedSlope, detail_of
from contact.model.registry import Named, anew, construct, parameters
from sie import Array

# Value of the property `summits` for shapes whose only tip is at x = 0.
AT_ORIGIN = np.zeros(1)
AT_ORIGIN.setflags(write=False)


def onto(ends: tuple[float, float], at: Array, slack: Array | float) -> Array:
    """Move places that round-off has put just outside an interval onto its ends.

    A corner whose place is computed with round-off still belongs to the body.
    """
    lo, hi = ends
    return np.where(
        (at < lo) & (at >= lo - slack), lo, np.where((at > hi) & (at <= hi + slack), hi, at)
    )


def _midpoints(lo: float, hi: float, count: int) -> Array:
    """Midpoints of `count` equal parts of an interval."""
    return np.asarray(lo + (hi - lo) * (np.arange(count) + 0.5) / count)


def is_of_package(profile: "Profile") -> bool:
    """Whether the classes of a profile and of the bodies in it belong to the package `contact`."""
    inner = getattr(profile, "profile", None)
    parts = [*profile.bodies.values(), *([inner] if isinstance(inner, Profile) else [])]
    return all(type(part).__module__.startswith("contact.") for part in (profile, *parts))


def read_from(name: str) -> Any:
    """A property that returns the attribute `name`, e.g. "profile.x" for `self.profile.x`."""
    return property(attrgetter(name))


class Profile(Named, sie.Kept):
    """The base class of profiles; subclasses are frozen dataclasses that check their fields.

    A profile has a `height(x)`: the gap at zero load [m], at x [m] of any shape, growing away from
    contact; a constant does not matter. All else may be left out: `slope`, `period`, `symmetric`,
    `kinks`, `jumps`, `algebraic_points`, `support`, `extent`, `summits`, `resolution` and
    `slope_conjugate` make solving faster or more accurate (docs/own-profile.md).

    Examples
    --------
    >>> import contact
    >>> import numpy as np
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Cosh(contact.Profile):
    ...     scale: float
    ...     def height(self, x):
    ...         return self.scale * np.cosh(np.asarray(x) / self.scale)
    >>> solution = contact.solve(contact.Scene(Cosh(1.0), 1e9, contact.Isolated(), load=1e4))
    >>> len(solution.zones), solution.error < 1e-8
    (1, True)
    """

    # Units of the parameters by name, used in tables and as labels of axes.
    units: ClassVar[Mapping[str, str]] = {}
    period: float | None = None

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        # In a subclass, a field `period: float` is meant to be required. The class attribute None
        # must not become the default of this field.
        if "period" in inspect.get_annotations(cls) and "period" not in cls.__dict__:
            cls.period = dataclasses.field()

    def height(self, x: ArrayLike) -> Array:
        """f(x): the gap at zero load [m], up to a constant, as an array of the same shape as x.

        It is periodic if the profile is.
        """
        raise NotImplementedError(f"{type(self).__name__} must define height(x)")

    def slope(self, x: ArrayLike) -> Array:
        """f'(x), the slope; computed numerically from the height unless a subclass defines it."""
        return self._derived(np.asarray(x, dtype=np.float64))

    @cached_property
    def _derived(self) -> DerivedSlope:
        ends = self.extent if self.support is None else self.support
        return DerivedSlope(self.height, self._length(), ends, self.period)

    @cached_property
    def slope_rounding(self) -> float:
        """Round-off error of a slope computed from heights. It is 0 if the profile defines its
        slope, or if the profile has neither a cell nor ends.
        """
        known = self.support or self.known
        if not self.slope_is_derived or known is None:
            return 0.0
        return self._derived.rounding(_midpoints(*known, DIFFERENCES.together))

    @property
    def slope_is_derived(self) -> bool:
        """Whether the slope f' is computed numerically from the height f, instead of being defined
        by the profile's author.
        """
        return type(self).slope is Profile.slope

    @property
    def symmetric(self) -> bool:
        """Whether the profile is symmetric: f(-x) = f(x)."""
        return False

    @property
    def kinks(self) -> Array:
        """Jumps of the slope f' in the cell. Each row is the position s and the jump f'(s+) -
        f'(s-).
        """
        return np.empty((0, 2))

    @property
    def jumps(self) -> Array:
        """Jumps of the second and third derivatives in the cell. Each row is the position s, the
        order n = 2 or 3, and the jump f^(n)(s+) - f^(n)(s-).

        Jumps need not be declared. A declared jump costs no accuracy and few further unknowns.
        """
        return np.empty((0, 3))

    @property
    def algebraic_points(self) -> Array:
        """Places s in the cell near which f is a smooth function plus a power n > 1 of the
        distance from s.

        Each row has the position s, the exponent n, and the coefficients [m^(1-n)] of (s - x)^n for
        x < s and of (x - s)^n for x > s. A power that is a whole number can also be declared as a
        jump.
        """
        return np.empty((0, 4))

    @property
    def support(self) -> tuple[float, float] | None:
        """The interval outside which f = +inf, for a punch with sharp corners; None for other
        shapes.
        """
        return None

    @property
    def extent(self) -> tuple[float, float] | None:
        """The interval in which f is known, for a measured trace without a period; None for other
        shapes.
        """
        return None

    @property
    def known(self) -> tuple[float, float] | None:
        """The interval in which f is known: the periodic cell, or the extent of a trace.
        None if f is known everywhere.
        """
        return self.extent if self.period is None else (self.x0, self.x0 + self.period)

    @property
    def x0(self) -> float:
        """Left end of the periodic cell; -inf without a period."""
        return -math.inf if self.period is None else -0.5 * self.period

    @property
    def summits(self) -> Array | None:
        """The tips in the cell (local minima of f); None if the solver must search for them."""
        return None

    @property
    def resolution(self) -> float | None:
        """Smallest length over which the shape varies; None if unknown.

        The default, for a periodic profile, is found from its heights.
        """
        return self._detail

    @cached_property
    def _detail(self) -> float | None:
        return (
            None
            if self.period is None
            else detail_of(self.height, *(self.support or (self.x0, self.x0 + self.period)))
        )

    @property
    def feature(self) -> float | None:
        """Typical length of the shape's features; None if unknown.
        It sets the step of the first grid in a search.
        """
        return self.resolution

    @property
    def exact_places(self) -> bool:
        """Whether `slope(x)` is accurate for the floating-point number x as given. Otherwise the
        slope has the error that the round-off of x / period causes.
        """
        return False

    @property
    def breakpoints(self) -> Array:
        """Positions in the cell at which f or one of its derivatives jumps."""
        return np.unique(
            np.concatenate((self.kinks[:, 0], self.jumps[:, 0], self.algebraic_points[:, 0]))
        )

    def slope_conjugate(self, x: ArrayLike) -> Array | None:
        """The Hilbert transform H f' = (1/L) PV int f'(xi) cot(pi (x - xi)/L) dxi over a period L;
        None if there is no formula for it.
        """
        return None

    @cached_property
    def slopes_seen(self) -> Array:
        """Finite slopes at equally spaced places of the period or of the known interval; empty if
        the profile has neither.
        """
        if self.known is None:
            return np.zeros(0)
        lo, hi = self.known
        with np.errstate(all="ignore"):
            slopes = np.asarray(self.slope(_midpoints(lo, hi, DETAIL.samples)), dtype=float)
        return np.asarray(slopes[np.isfinite(slopes)])

    @cached_property
    def slope_sizes(self) -> tuple[float, float]:
        """The largest absolute value and the root mean square of the slopes `slopes_seen`."""
        seen = self.slopes_seen
        return (
            (float(np.abs(seen).max()), float(np.sqrt(np.mean(seen**2))))
            if seen.size
            else (0.0, 0.0)
        )

    @cached_property
    def claims_seen(self) -> dict[tuple[float, float], Any]:
        """Cache of the results of contact.formulation.claims, with one result for each interval."""
        return {}

    def wrap(self, x: ArrayLike) -> Any:
        """x moved by whole periods into the cell [x0, x0 + L); an x inside the cell stays exactly
        the same.
        """
        given = np.asarray(x)
        if self.period is None:
            return given
        lo = self.x0
        # For numpy arrays, argmin and argmax are faster than min and max.
        if (
            given.dtype == np.float64
            and given.size
            and lo <= given.item(given.argmin())
            and given.item(given.argmax()) < lo + self.period
        ):
            return given
        # Only the real part of x is used here, since x may be complex: x + ih in the complex-step
        # derivative.
        turns = np.floor((given.real - lo) / self.period)
        moved = given - self.period * turns
        # Round-off can leave the result just outside the cell on either side.
        moved = np.where(moved.real < lo, lo + (moved - moved.real), moved)
        return np.where(moved.real >= lo + self.period, lo + (moved - moved.real), moved)

    @classmethod
    def from_table(cls, table: Mapping[str, Any], directory: str | Path = ".") -> Any:
        """The profile that a scene file's table describes; the table comes without its key
        `shape`.

        File names are relative to `directory`.
        """
        return construct(cls, f"profile {cls.name!r}", table)

    def unit_of(self, name: str, index: int) -> "Profile | None":
        """The profile that is added if entry `index` of the array parameter `name` grows by 1.
        It exists only if the heights are a sum of terms proportional to the entries. Otherwise, or
        if it is not known, None is returned.
        """
        return None

    def unit_sums(self, name: str, x: Array, heights: Array, slopes: Array) -> Array | None:
        """For each profile of `unit_of`, a weighted sum of its heights and slopes at places x.

        heights, slopes: the weights of the heights and of the slopes. None if there is no method
        that computes the sums for all entries at once.
        """
        return None

    def parameters(self) -> dict[str, Any]:
        """Arguments by name from which the class can make an equal profile."""
        return parameters(self)

    @property
    def bodies(self) -> "dict[str, Profile]":
        """The profiles of the bodies, each under the name of its table in a scene file."""
        return {"profile": self}

    def facing(self, x: Array) -> dict[str, Array]:
        """For each body, the place that faces the point x, in the coordinate of that body."""
        return {"profile": x}

    @property
    def title(self) -> str:
        """Name of the profile in pictures and tables."""
        return self.name

    def tables(self) -> dict[str, dict[str, Any]]:
        """Tables of a scene file that describe the profile, with its shape and parameters."""
        return {"profile": {"shape": self.name, **self.parameters()}}

    @property
    def preparation(self) -> dict[str, Any]:
        """Arguments with which measured points were prepared, by name; empty for shapes without
        measured points.
        """
        return {}

    def unprepared(self) -> dict[str, Any]:
        """Measured points before their preparation, by name; empty for shapes without measured
        points.
        """
        return {}

    @property
    def unmeasured(self) -> tuple[Any, ...]:
        """Intervals (left, right, kind) [m] in which a prepared trace has no measured heights."""
        return ()

    def varied(self, changes: Mapping[str, Mapping[str, Any]]) -> "Profile":
        """The profile with the new parameter values from the table `profile` of `changes`."""
        return anew(type(self), {**self.parameters(), **changes.get("profile", {})})

    @property
    def no_period(self) -> str:
        """End of the error message if a period is needed and the profile has none."""
        return f"the {self.name} profile has no period"

    def counter_height(self, x: ArrayLike) -> Array:
        """Heights [m] of the counter-face at zero load, positive upwards, up to a constant.

        They are 0 unless the counter body is rough, too.
        """
        return np.zeros(np.shape(x))

    def trace_summary(self) -> dict[str, Any] | None:
        """Source, preparation and roughness [m] of a measured trace; None for other profiles."""
        return None

    def _length(self) -> float | None:
        """A typical length of the shape, which sets the steps of numerical differences."""
        if self.resolution is not None:
            return self.resolution
        if self.support is not None:
            return self.support[1] - self.support[0]
        return self.period

    def _fields(self) -> tuple[Any, ...]:
        fields = dataclasses.fields(self)  # type: ignore[arg-type]
        return tuple(getattr(self, field.name) for field in fields if field.compare)

    # Some dataclasses are made with eq=False, because one of their fields is an array. The methods
    # `__eq__` and `__hash__` here serve these dataclasses.
    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self) or not dataclasses.is_dataclass(self):
            return self is other if type(other) is type(self) else NotImplemented
        return all(
            np.array_equal(a, b) for a, b in zip(self._fields(), other._fields(), strict=True)
        )

    def __hash__(self) -> int:
        if not dataclasses.is_dataclass(self):
            return id(self)
        return hash(
            (type(self), *(v.tobytes() if isinstance(v, np.ndarray) else v for v in self._fields()))
        )
