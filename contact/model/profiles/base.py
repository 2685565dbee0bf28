"""What a profile is: the gap f(x) at zero load, its slope f'(x), and what else is known of it.

Only `height` must be given. f grows away from contact (a punch pointing down); any constant offset
is irrelevant to zones and pressures. A periodic profile repeats the cell [x0, x0 + L).
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
from contact.model.profiles.derive import DerivedSlope, detail_of
from contact.model.registry import Named, anew, construct, parameters
from sie import Array

# Places a period at which slopes are read.
_PLACES = 1024
# Places at which the noise of a derived slope is looked at: its median hardly depends on them.
_LOOKS = 64

# The one tip of many shapes.
AT_ORIGIN = np.zeros(1)
AT_ORIGIN.setflags(write=False)


def onto(ends: tuple[float, float], at: Array, slack: Array | float) -> Array:
    """Places with those that rounding has put just beyond an end moved back onto it: a corner
    reached by arithmetic is still the body's.
    """
    lo, hi = ends
    return np.where(
        (at < lo) & (at >= lo - slack), lo, np.where((at > hi) & (at <= hi + slack), hi, at)
    )


def is_of_package(profile: "Profile") -> bool:
    """Whether the classes of a profile and of its bodies are the package's own."""
    inner = getattr(profile, "profile", None)
    parts = [*profile.bodies.values(), *([inner] if isinstance(inner, Profile) else [])]
    return all(type(part).__module__.startswith("contact.") for part in (profile, *parts))


def told_by(name: str) -> Any:
    """A property that is a parameter, or what a part says of itself: `told_by("width")`,
    `told_by("profile.support")`.
    """
    return property(attrgetter(name))


class Profile(Named, sie.Kept):
    """Base of all profiles; subclasses are frozen dataclasses that check their fields when made.

    A profile has a `height(x)`: the gap at zero load [m], at x [m] of any shape, growing away from
    contact; a constant does not matter. All else may be left out: `slope`, `period`, `symmetric`,
    `kinks`, `jumps`, `algebraic_points`, `support`, `extent`, `summits`, `resolution`,
    `slope_conjugate` make solving faster or sharper (docs/own-profile.md).

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

    # Of parameters, by name, as tables and axes tell them; what is not here has none told.
    units: ClassVar[Mapping[str, str]] = {}
    period: float | None = None

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        # A field `period: float` is meant to be required; the None above must not become its
        # default.
        if "period" in inspect.get_annotations(cls) and "period" not in cls.__dict__:
            cls.period = dataclasses.field()

    def height(self, x: ArrayLike) -> Array:
        """f(x), the gap at zero load up to a constant [m]; any array shape; periodic if the profile
        is.
        """
        raise NotImplementedError(f"{type(self).__name__} must define height(x)")

    def slope(self, x: ArrayLike) -> Array:
        """f'(x), derived numerically from the height: give it in closed form where you can."""
        return self._derived(np.asarray(x, dtype=np.float64))

    @cached_property
    def _derived(self) -> DerivedSlope:
        ends = self.extent if self.support is None else self.support
        return DerivedSlope(self.height, self._length(), ends, self.period)

    @cached_property
    def slope_rounding(self) -> float:
        """Noise of a slope that is derived from the heights of a cell, or of a known part; else 0."""
        known = self.support or self.known
        if not self.slope_is_derived or known is None:
            return 0.0
        lo, hi = known
        return self._derived.rounding(lo + (hi - lo) * (np.arange(_LOOKS) + 0.5) / _LOOKS)

    @property
    def slope_is_derived(self) -> bool:
        """Whether f' is the numerical derivative of f rather than the author's own."""
        return type(self).slope is Profile.slope

    @property
    def symmetric(self) -> bool:
        """Whether f(-x) = f(x)."""
        return False

    @property
    def kinks(self) -> Array:
        """Slope jumps in the cell, one a row: position, f'(s+) - f'(s-)."""
        return np.empty((0, 2))

    @property
    def jumps(self) -> Array:
        """Jumps of f^(n), n = 2 or 3, in the cell, one a row: position, n, f^(n)(s+) - f^(n)(s-).

        None need be declared; those that are cost no accuracy and few modes.
        """
        return np.empty((0, 3))

    @property
    def algebraic_points(self) -> Array:
        """Places in the cell beside which f is smooth but for a power n > 1, one a row: position s,
        exponent n, and the coefficients of (s - x)^n for x < s and of (x - s)^n for x > s
        [m^(1-n)].

        None need be declared; a power that is not a whole number has no other way to be told.
        """
        return np.empty((0, 4))

    @property
    def support(self) -> tuple[float, float] | None:
        """The interval beyond which f = +inf (a sharp-cornered punch); None if there is no such
        end.
        """
        return None

    @property
    def extent(self) -> tuple[float, float] | None:
        """The interval within which f is known (a measured trace just ends); None: known
        everywhere.
        """
        return None

    @property
    def known(self) -> tuple[float, float] | None:
        """One cell, or the extent without a period; None: the whole line."""
        return self.extent if self.period is None else (self.x0, self.x0 + self.period)

    @property
    def x0(self) -> float:
        """Left end of the periodic cell; -inf without a period."""
        return -math.inf if self.period is None else -0.5 * self.period

    @property
    def summits(self) -> Array | None:
        """The tips in the cell (local minima of f); None if they must be searched for."""
        return None

    @property
    def resolution(self) -> float | None:
        """Smallest length over which the shape varies: of one that repeats, if not given, as its
        heights tell; None if unknown.
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
        """Length over which most of the shape varies: as closely as this asks for a first guess
        looks at it.
        """
        return self.resolution

    @property
    def exact_places(self) -> bool:
        """Whether `slope` is that at the very number x: of the product of a wave number and x, say,
        no digit is lost.
        """
        return False

    @property
    def breakpoints(self) -> Array:
        """Positions in the cell where f or one of its derivatives jumps."""
        return np.unique(
            np.concatenate((self.kinks[:, 0], self.jumps[:, 0], self.algebraic_points[:, 0]))
        )

    def slope_conjugate(self, x: ArrayLike) -> Array | None:
        """H f' = (1/L) PV int f'(xi) cot(pi (x - xi)/L) dxi over a period; None if not known."""
        return None

    @cached_property
    def slopes_seen(self) -> Array:
        """Finite slopes at even places over the period, or where the shape is known; none of a body
        without either.
        """
        if self.known is None:
            return np.zeros(0)
        lo, hi = self.known
        with np.errstate(all="ignore"):
            slopes = np.asarray(
                self.slope(lo + (hi - lo) * (np.arange(_PLACES) + 0.5) / _PLACES), dtype=float
            )
        return np.asarray(slopes[np.isfinite(slopes)])

    @cached_property
    def slope_sizes(self) -> tuple[float, float]:
        """(largest, root mean square) of these slopes."""
        seen = self.slopes_seen
        return (
            (float(np.abs(seen).max()), float(np.sqrt(np.mean(seen**2))))
            if seen.size
            else (0.0, 0.0)
        )

    @cached_property
    def claims_seen(self) -> dict[tuple[float, float], Any]:
        """Results of contact.formulation.claims, by interval."""
        return {}

    def wrap(self, x: ArrayLike) -> Any:
        """x moved by whole periods into [x0, x0 + L), bit for bit the same if already there."""
        given = np.asarray(x)
        if self.period is None:
            return given
        lo = self.x0
        # By their places, which few numbers are searched for faster than for themselves.
        if (
            given.dtype == np.float64
            and given.size
            and lo <= given.item(given.argmin())
            and given.item(given.argmax()) < lo + self.period
        ):
            return given
        # The real part alone decides: complex arguments come from the complex-step derivative.
        turns = np.floor((given.real - lo) / self.period)
        moved = given - self.period * turns
        # Rounding can leave the result a hair outside on either side.
        moved = np.where(moved.real < lo, lo + (moved - moved.real), moved)
        return np.where(moved.real >= lo + self.period, lo + (moved - moved.real), moved)

    @classmethod
    def from_table(cls, table: Mapping[str, Any], directory: str | Path = ".") -> Any:
        """The profile of a scene file's table without its `shape`; files are looked for from
        `directory`.
        """
        return construct(cls, f"profile {cls.name!r}", table)

    def parameters(self) -> dict[str, Any]:
        """What to give the class, by name, to make this profile again."""
        return parameters(self)

    @property
    def bodies(self) -> "dict[str, Profile]":
        """The profiles of the bodies whose gap this is, by the table of a scene file that tells
        each: of one body this one.
        """
        return {"profile": self}

    def facing(self, x: Array) -> dict[str, Array]:
        """The places of the bodies at x, each told as its own profile counts them."""
        return {"profile": x}

    @property
    def title(self) -> str:
        """What pictures and tables call it."""
        return self.name

    def tables(self) -> dict[str, dict[str, Any]]:
        """What a scene file says of it: by table, the shape and its parameters."""
        return {"profile": {"shape": self.name, **self.parameters()}}

    @property
    def preparation(self) -> dict[str, Any]:
        """Of measured points: the keys by which they were prepared, with their values; none of any
        other shape.
        """
        return {}

    def unprepared(self) -> dict[str, Any]:
        """What there was before, by name."""
        return {}

    @property
    def unmeasured(self) -> tuple[Any, ...]:
        """Intervals (left, right, kind) [m] of a prepared trace whose heights were not measured."""
        return ()

    def varied(self, changes: Mapping[str, Mapping[str, Any]]) -> "Profile":
        """The same with other values of parameters, by table and name."""
        return anew(type(self), {**self.parameters(), **changes.get("profile", {})})

    @property
    def no_period(self) -> str:
        """Said where a period is asked for and there is none."""
        return f"the {self.name} profile has none"

    def counter_height(self, x: ArrayLike) -> Array:
        """Heights of the counter-face at zero load [m], up to a constant, upwards: 0, unless the
        counter body is rough too.
        """
        return np.zeros(np.shape(x))

    def trace_summary(self) -> dict[str, Any] | None:
        """Of a measured trace: what was read and done to it, and its roughness, lengths in m; None
        for other shapes.
        """
        return None

    def _length(self) -> float | None:
        """A length typical of the shape, for the steps of numerical differences."""
        if self.resolution is not None:
            return self.resolution
        if self.support is not None:
            return self.support[1] - self.support[0]
        return self.period

    def _fields(self) -> tuple[Any, ...]:
        return tuple(getattr(self, f.name) for f in dataclasses.fields(self) if f.compare)  # type: ignore[arg-type]

    # Equality and hash for dataclasses made with eq=False because a field is an array.
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
