"""A measured profile: the interpolating cubic spline, f = max(height) - height(x).

The spline is C2, periodic or with the not-a-knot condition at both ends (C. de Boor, A Practical
Guide to Splines). Nothing is smoothed: the spline passes through all measured points.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

import sie
from contact.errors import SceneError, warn
from contact.extras import require
from contact.model.checks import finite_array, increasing, metres, one_of, positive_or_none, text
from contact.model.profiles.base import Array, Profile, onto
from contact.model.profiles.noise import EPS
from contact.model.registry import register_profile

# Modules that are loaded only when a trace file, roughness or unmeasured intervals are needed.
_READING = "contact.model.traces.prepare"
_ROUGHNESS = "contact.model.traces.roughness"
_UNMEASURED = "contact.model.traces.unmeasured"

# Arguments of the preparation of a trace that may be whole numbers.
_WHOLE = ("detrend", "regrid")


# Names of the arguments of `Sampled.prepared`.
_PREPARED = tuple("units sort invert fill regrid lambda_s detrend lambda_c taper period".split())

# A not-a-knot cubic spline needs four points, as a cubic has four coefficients.
MIN_POINTS = 4


@dataclass(frozen=True)
class SampledOptions:
    """Relative tolerance with which lengths, or heights, of a measured profile count as equal.

    same: largest relative difference, in position and height, at which the last point is the first
    one, repeated after a period.
    """

    same: float = 1e-9


OPTIONS = SampledOptions()


def read_trace(
    path_or_arrays: Any,
    columns: Sequence[int | str] = (),
    units: str | Sequence[str] | None = None,
    detrend: str | int = "none",
    regrid: bool | int | None = None,
    taper: float | None = None,
    period: bool | float | None = None,
    *,
    pitch: float | None = None,
    decimal: str | None = None,
    delimiter: str | None = None,
    fill: str | None = None,
    missing: str | float | None = None,
    sort: bool = False,
    lambda_s: float | None = None,
    lambda_c: float | None = None,
    channel: str | int | None = None,
    line: int | Sequence[Sequence[float]] | None = None,
    along: str | None = None,
    invert: bool | None = None,
) -> Sampled:
    """Read a measured trace from a file or from arrays, and prepare it as the arguments say.

    The table [profile] of a scene file with a `file` has keys of the same names. The steps are, in
    this order: read, sort, invert, fill, regrid, lambda_s, detrend, lambda_c, taper, period; the
    profile's `history` says what was done. A file that can be read in two ways is refused; the
    message shows both.

    Parameters
    ----------
    path_or_arrays : str, path, file object, pair of arrays, array, or line scan
        The points: arrays (x, z), or heights z with their pitch; NaN and masked heights are
        missing; arrays of pint are read in their units. Or a line scan of SurfaceTopography. Or a
        file: its name, or an open file or stream of text or bytes. Endings such as x3p, sur, opd,
        plu, OPDx, gwy, nc (of SurfaceTopography) or xlsx (of Mitutoyo SurfTest) are read by the
        extra `instruments`. All others are text, in UTF-8, UTF-16 or Latin-1, also under gzip: two
        columns, or the rows x, y, z of a map.
    columns : sequence of int or str
        Columns of positions and heights (of a map: x, y and z), from 0 or by name; may be left out
        if no other columns hold numbers.
    units : str or two of them, or None
        m, cm, mm, um, nm, A, pm, in, mil and others: one unit for positions and heights, or one for
        each. None: the units of the header, else m (arrays: m).
    detrend : str or int
        "none", "line", "quadratic", or the degree of the least-squares polynomial that is
        subtracted (the form).
    regrid : bool, int or None
        Number of evenly spaced positions to which heights are interpolated; True: as many as there
        are points.
    taper : float or None
        Part of the length, at each end, over which heights are brought to one height.
    period : bool, float or None
        Length of the period [m]; True: the measured length; None: the trace just ends.
    pitch : float or None
        Distance [m] of successive points, if only heights are given.
    decimal, delimiter : str or None
        Decimal mark "." or ","; delimiter ";", ",", "tab" or "blank". None: recognized.
    fill : str or None
        What is done where a height is missing: "linear", straight lines; "drop", the points are
        left out; None: it is refused.
    missing : str, float or None
        What stands in the file for a missing height, besides empty cells, nan, #N/A, No Data and
        the like. A text such as "-32768" means the number.
    sort : bool
        Whether points out of order are sorted by position. Positions that descend throughout are
        always reversed.
    lambda_s, lambda_c : float or None
        Cut-offs [m] of Gaussian filters (ISO 16610-21): shorter waves than lambda_s, and longer
        ones than lambda_c, are filtered out.
    channel : str, int or None
        Which channel of an instrument's file is read: its name, or its number, from 0, among the
        channels of heights.
    line : int, or two points, or None
        Which line of a map is read: its number, from 0, or its end points `[[x, y], [x, y]]` in
        metres. A text file gives a map as rows of x, y and z on a grid.
    along : str or None
        "x" (as if left out) or "y": the direction of a numbered line.
    invert : bool or None
        Whether heights are turned upside down. None: they are not turned, and they are refused if
        the header calls them depths.

    Returns
    -------
    Sampled

    Raises
    ------
    SceneError
        If the file cannot be read, if it can be read in two ways, or if an argument is wrong.
    MissingExtra
        If an instrument's own format needs the extra `instruments`.

    Warns
    -----
    ModelWarning
        If length, pitch or heights are unlike those of a surface, if positions may only count the
        points, if a height may mark a missing one or is a spike, or if more than a tenth of the
        heights is missing.

    Examples
    --------
    >>> import contact, pathlib, tempfile
    >>> text = "x [um];z [nm]\\n0,0;3,1\\n0,5;nan\\n1,0;5,3\\n1,5;4,2\\n2,0;2,0\\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder) / "trace.csv"
    ...     _ = file.write_text(text)
    ...     trace = contact.read_trace(file, fill="linear")
    >>> trace.heights.round(12).tolist()
    [3.1e-09, 4.2e-09, 5.3e-09, 4.2e-09, 2e-09]
    >>> trace.history[1]
    '1 of 5 heights are missing; 1 in 1 gaps, the widest 1 µm, filled by straight lines'
    """
    keys = dict(locals())
    profile = _of_trace(require(_READING).load_trace(keys.pop("path_or_arrays"), **keys))
    warn(profile.warnings)
    return profile


@register_profile("sampled")
@dataclass(frozen=True, init=False, repr=False, eq=False)
class Sampled(Profile):
    """Measured points: positions x in ascending order, and heights, positive upwards. If a
    period is given, the points are those of one period.

    A last point one period after the first is dropped if it repeats the first height. Without a
    period the profile is known only between its first and last points (`extent`): f is nan outside.
    The parameter `height` is stored as `heights` because `height(x)` is f for every profile.
    `history` says what was done to a file's points, `warnings` what is doubtful about them.
    `contact.read_trace` (and `Sampled.from_file`) reads a file.

    Parameters
    ----------
    x : array_like
        Positions [m], (n,), n >= 4, increasing.
    height : array_like
        Heights [m], (n,), the asperities upwards; f = max(height) - the cubic spline through the
        points (C. de Boor, A Practical Guide to Splines, 1978), periodic or not-a-knot.
    period : float or None
        Length of the period [m]; None: the trace just ends.

    Raises
    ------
    SceneError
        If positions do not increase, lengths differ, a number is not finite, or all heights are the
        same.

    Examples
    --------
    >>> import contact
    >>> import numpy as np
    >>> x = np.linspace(0.0, 1.0, 65)
    >>> trace = contact.Sampled(x, 0.01 * np.cos(2 * np.pi * x), period=1.0)
    >>> float(trace.height(0.5).round(12)), len(trace.x)
    (0.02, 64)
    """

    x: Array
    heights: Array
    period: float | None = None
    history: tuple[str, ...] = field(default=(), compare=False, repr=False)
    warnings: tuple[str, ...] = field(default=(), compare=False, repr=False)
    units = {"period": "m", "lambda_s": "m", "lambda_c": "m", "taper": "1"}
    # A pair: the points as read, and the preparation of these points. None for points that were not
    # prepared.
    source: ClassVar[tuple[Any, Any] | None] = None

    def __init__(self, x: ArrayLike, height: ArrayLike, period: float | None = None) -> None:
        points = increasing("x", metres("x", x), MIN_POINTS)
        heights = finite_array("height", metres("height", height), 1, MIN_POINTS)
        if heights.size != points.size:
            raise SceneError.of(
                "height",
                height,
                f"as many heights as positions x ({points.size}, not {heights.size})",
            )
        length = positive_or_none("period", metres("period", period))
        if length is not None:
            points, heights = _one_period(points, heights, length)
        if not np.ptp(heights) > 4 * EPS * np.max(np.abs(heights)):
            raise SceneError.of("height", height, "heights that are not all equal")
        for name, value in (
            ("x", points),
            ("heights", heights),
            ("period", length),
            ("history", ()),
            ("warnings", ()),
        ):
            object.__setattr__(self, name, value)

    from_file = staticmethod(read_trace)

    @classmethod
    def prepared(cls, x: ArrayLike, z: ArrayLike, **preparation: Any) -> Sampled:
        """The profile of measured arrays, prepared in memory like the points of a file.

        Parameters
        ----------
        x, z : array_like
            Positions and heights [m], or quantities of pint; heights that are NaN are missing.
        **preparation
            Arguments of `contact.read_trace`: units, sort, invert, fill, regrid, lambda_s, detrend,
            lambda_c, taper, period.

        Returns
        -------
        Sampled

        Raises
        ------
        SceneError
            If arrays or arguments are wrong; the message names which.

        Warns
        -----
        ModelWarning
            If lengths or heights are unlike those of a surface, as for `contact.read_trace`.

        Examples
        --------
        >>> import contact
        >>> import numpy as np
        >>> x = np.linspace(0.0, 1e-3, 201)
        >>> z = 1e-6 * np.cos(4e4 * x) + 1e-3 * x
        >>> trace = contact.Sampled.prepared(x, z, detrend="line", taper=0.1, period=True)
        >>> trace.history[1]
        'least-squares line subtracted'
        """
        for key in preparation:
            one_of("argument of Sampled.prepared", key, _PREPARED)
        profile = _of_trace(require(_READING).load_trace((x, z), **preparation))
        warn(profile.warnings)
        return profile

    @classmethod
    def from_table(cls, table: Mapping[str, Any], directory: str | Path = ".") -> Any:
        """The profile of a scene file's table, which has points `x` and `height`, or a `file` and
        arguments of `read_trace`.
        """
        if not isinstance(table, Mapping):
            raise SceneError.of("table", table, "a mapping of parameters")
        if "file" not in table:
            return super().from_table(table, directory)
        rest = {key: value for key, value in table.items() if key != "file"}
        _, *known = inspect.signature(read_trace).parameters
        for key in rest:
            one_of("parameter of profile 'sampled' with a file", key, ("file", *known))
        return read_trace(Path(directory) / text("file", table["file"]), **rest)

    def __repr__(self) -> str:
        return (
            f"Sampled({self.x.size} points from {self.x[0]:.6g} to {self.x[-1]:.6g}, "
            f"period={self.period!r})"
        )

    def parameters(self) -> dict[str, Any]:
        return {"x": self.x, "height": self.heights, "period": self.period}

    @property
    def no_period(self) -> str:
        return (
            f"the {self.name} profile has no period: give one, or read the trace with period = "
            "true (its length) and taper (which brings both ends to the same height)"
        )

    @property
    def preparation(self) -> dict[str, Any]:
        return {} if self.source is None else vars(self.source[1])

    def unprepared(self) -> dict[str, Any]:
        return (
            {} if self.source is None else {"x": self.source[0].x, "height": self.source[0].height}
        )

    def varied(self, changes: Mapping[str, Mapping[str, Any]]) -> Profile:
        """The profile with other values of its parameters. If a changed parameter belongs to the
        preparation, the points of the file are prepared again.
        """
        own = changes.get("profile", {})
        if self.source is None or not set(own) - set(self.parameters()):
            return super().varied(changes)
        whole = {
            key: int(value)
            for key, value in own.items()
            if key in _WHOLE and isinstance(value, float) and value == int(value)
        }
        return _prepared_again(self.source[0], replace(self.source[1], **{**own, **whole}))

    @cached_property
    def unmeasured(self) -> tuple[Any, ...]:
        return tuple(require(_UNMEASURED).intervals(self.source, self.x, self.period))

    def trace_summary(self) -> dict[str, Any]:
        return {"history": list(self.history), **vars(require(_ROUGHNESS).roughness(self))}

    def unit_of(self, name: str, index: int) -> Profile | None:
        if name != "height":
            return None
        return Sampled(self.x, np.where(np.arange(self.x.size) == index, 1.0, 0.0), self.period)

    def height(self, x: ArrayLike) -> Array:
        return np.asarray(-self._spline(self._inside(x)))

    def slope(self, x: ArrayLike) -> Array:
        return np.asarray(-self._spline(self._inside(x), 1))

    def slope_conjugate(self, x: ArrayLike) -> Array | None:
        """The Hilbert transform H f' of the slope in closed form; None without a period."""
        if self._conjugate is None:
            return None
        return self._conjugate(np.asarray(self.wrap(np.asarray(x, dtype=np.float64))))

    @property
    def x0(self) -> float:
        return float(self.x[0])

    @property
    def extent(self) -> tuple[float, float] | None:
        return None if self.period is not None else (float(self.x[0]), float(self.x[-1]))

    @property
    def breakpoints(self) -> Array:
        """The knots of the spline at which its third derivative jumps. A not-a-knot spline has no
        jump at the first two and the last two points.
        """
        return np.array(self.x if self.period is not None else self.x[2:-2])

    @property
    def jumps(self) -> Array:
        """The jumps of the third derivative of f at the knots, between which f is a cubic
        polynomial.
        """
        third = -6.0 * self._spline.c[0]
        # With a period, the spline's last cubic continues to the left of the first knot.
        first, before = (0, third[-1:]) if self.period is not None else (1, third[:0])
        at = self._knots[first:-1]
        return np.column_stack((at, np.full(at.size, 3.0), np.diff(third, prepend=before)))

    @cached_property
    def resolution(self) -> float:
        return float(np.min(np.diff(self._knots)))

    @property
    def feature(self) -> float:
        return float(np.median(np.diff(self._knots)))

    @property
    def _knots(self) -> Array:
        return self.x if self.period is None else np.append(self.x, self.x[0] + self.period)

    @cached_property
    def _spline(self) -> Any:
        # Depths count from the highest point, so that an offset of the instrument's zero costs no
        # digits.
        depth, repeats = self.heights - self.heights.max(), self.period is not None
        values, kind = (
            (np.append(depth, depth[0]), "periodic") if repeats else (depth, "not-a-knot")
        )
        return require("scipy.interpolate").CubicSpline(
            self._knots, values, bc_type=kind, extrapolate=repeats
        )

    @cached_property
    def _conjugate(self) -> sie.PiecewiseTransform | None:
        if self.period is None:
            return None
        third, second, first, _ = self._spline.c
        jumps = self.jumps
        slope = -np.column_stack((first, 2 * second, 3 * third))
        return sie.PiecewiseTransform(
            sie.hilbert(self.period), self._knots, slope, jumps[:, 0], jumps[:, 2]
        )

    def _inside(self, x: ArrayLike) -> Array:
        w = np.asarray(self.wrap(np.asarray(x, dtype=np.float64)))
        if self.period is not None:
            return w
        # Outside the first and last points the spline returns NaN. So places that are outside only
        # by round-off are moved onto these points.
        lo, hi = self.x[0], self.x[-1]
        return onto((lo, hi), w, 8 * EPS * max(abs(lo), abs(hi), hi - lo))


@lru_cache(maxsize=8)
def _prepared_again(reading: Any, preparation: Any) -> Sampled:
    """Prepare the points of one file in another way; the result is cached for sweeps."""
    return _of_trace(require(_READING).prepared(reading, preparation))


def _of_trace(trace: Any) -> Sampled:
    try:
        profile = Sampled(trace.x, trace.height, trace.period)
    except SceneError as error:
        if trace.source is None:
            raise
        path = trace.source[0].path
        of = getattr(path, "words", f"file {str(path)!r}")
        raise SceneError(f"{of}: {error}", error.field, error.value, error.allowed) from error
    for name in ("history", "warnings", "source"):
        object.__setattr__(profile, name, getattr(trace, name))
    return profile


def _one_period(x: Array, heights: Array, period: float) -> tuple[Array, Array]:
    """The points of one period, without the last point if it repeats the first one."""
    length = float(x[-1] - x[0])
    if abs(length - period) <= OPTIONS.same * period:
        step = float(heights[-1] - heights[0])
        if abs(step) > OPTIONS.same * float(np.ptp(heights)):
            allowed = (
                "equal at both ends, as the last point is one period after the first (they differ "
                f"by {step:.3g} m)"
            )
            raise SceneError.of("height", heights, allowed)
        x, heights = x[:-1], heights[:-1]
    elif length > period:
        raise SceneError.of("period", period, f"at least the length of the trace, {length!r} m")
    if x.size < MIN_POINTS:
        raise SceneError.of("x", x, f"at least {MIN_POINTS} points in a period")
    return x, heights
