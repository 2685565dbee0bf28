"""The density on zones without slits, which can be evaluated on the zones and off them."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sie.basis.data import Array, Complex, Mask, by_rows
from sie.basis.kernels import Kernel, cauchy
from sie.basis.sums import OPTIONS as BLOCKS
from sie.basis.zones import Zones
from sie.density.plane import Plane
from sie.density.sampled import series_of
from sie.density.series import Series, from_zones, regular_at
from sie.density.treecode import Treecode
from sie.jumps.right_side import ForcingJumps
from sie.trees.far import reaches


@dataclass(frozen=True, eq=False)
class Density(Series):
    """The density phi(x), on each zone the sum of a Chebyshev series and closed forms of jumps.

    The series is sum_j c_j T_j(t) / sqrt(1 - t^2), -1 < t < 1. Calling the object gives phi at
    points of the line, zero off the zones. `transform`, `potential` and `transform_slope` also take
    complex points.

    Attributes
    ----------
    zones : Zones
        The zones, Z of them.
    kernel : Kernel
        The kernel of transform and potential.
    coefficients : ndarray
        Coefficients c_j of the series on each zone (Z, n + 1).
    jumps : ForcingJumps
        The jumps within the zones.
    amplitudes : ndarray
        Amplitudes of the equation's columns (k,).
    bounded_ends : bool
        Whether terms 1/sqrt(d) that round-off causes at free ends are removed, see
        `with_bounded_ends`.
    edges : tuple or None
        Coefficients (alpha, beta) of the unbounded part `singular`, if they differ from those that
        follow from `coefficients`.

    Examples
    --------
    The density 1 / sqrt(1 - x^2) of a flat punch, on the zone, and its transform 1 / sqrt(z^2 - 1)
    off it.

    >>> import numpy as np, sie
    >>> punch = sie.Equation(sie.cauchy(), sie.Forcing(np.zeros_like), (sie.Total(np.pi),))
    >>> density = sie.solve(punch, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR)).density
    >>> density([0.0, 0.6, 2.0]).round(12).tolist(), density.transform(1.25).round(12).tolist()
    ([1.0, 1.25, 0.0], 1.333333333333)
    >>> float(density.transform(0.75j).imag.round(12))
    -0.8
    >>> float(density.transform_slope(0.75j).real.round(12))
    0.384
    """

    @classmethod
    def from_function(
        cls,
        f: Callable[[Array], Array],
        zones: Zones,
        kernel: Kernel | None = None,
        tol: float = 1e-12,
    ) -> "Density":
        """A density given as a function of x, whose transform and potential can be evaluated.

        Near an end at the distance d the function must be K / sqrt(d) + A sqrt(d) + ...; at ends
        that are bounded or free, K is zero (or the prescribed intensity). Nothing is solved.

        Parameters
        ----------
        f : callable
            f(x), x (n,) inside the zones; it is not called at their ends.
        zones : Zones
            The zones with the kinds of their ends.
        kernel : Kernel or None
            The kernel of transform and potential; None stands for `cauchy()`.
        tol : float
            Relative tolerance of the coefficients on each zone, 0 < tol < 1.

        Returns
        -------
        Density

        Raises
        ------
        ValueError
            If the function is not finite or not real inside a zone, is not resolved to the
            tolerance, or is singular at an end that is declared bounded or free. The message names
            the zone and the cause, if one is found.

        Examples
        --------
        The pressure of a cylinder, sqrt(1 - x^2), has the transform x on the zone.

        >>> import numpy as np, sie
        >>> zone = sie.Zones.of([[-1.0, 1.0]])
        >>> hertz = sie.Density.from_function(lambda x: np.sqrt(1 - x**2), zone)
        >>> hertz.transform([0.5, 1.25]).round(12).tolist(), float(round(hertz.total, 12))
        ([0.5, 0.5], 1.570796326795)
        """
        kernel = cauchy() if kernel is None else kernel
        if not isinstance(kernel, Kernel):
            raise ValueError(
                f"the kernel must be a sie.Kernel, such as sie.cauchy(), got {kernel!r:.40}"
            )
        table, edges = series_of(f, zones, tol)
        return cls(zones, kernel, table, ForcingJumps.none(), np.zeros(0), edges=edges)

    @property
    def whole(self) -> "Density":
        """The density of the solution in which no gap is treated as a slit: this object itself."""
        return self

    @property
    def slit_count(self) -> int:
        """Number of narrow gaps treated as slits of wider zones: zero in this class."""
        return 0

    def opening(self, x: ArrayLike) -> tuple[Mask, Array]:
        """(whether x lies in a slit, integral of the slit's unknown function up to x).
        A slit is a narrow gap treated as part of a wide zone. Its unknown function is the right
        side minus the transform. The integral begins at the slit's left end.

        This density has no slits: false and zero everywhere.
        """
        shape = np.shape(x)
        return np.zeros(shape, dtype=bool), np.zeros(shape)

    @cached_property
    def plane(self) -> Plane:
        """Transform of the density, its derivative, and the potential, at complex points."""
        return Plane(self)

    def _with_slope(self, points: Complex) -> tuple[Complex, Complex]:
        return self.plane.with_slope(points)

    def _on_line(self, x: Array, potential: bool) -> Array:
        """Transform or potential at real x, as a sum over zones, computed directly or by a tree."""
        flat = self.into_period(x).ravel()
        regular = self.kernel.regular_potential if potential else self.kernel.regular
        zone, shift = (
            np.tile(np.arange(len(self.zones)), len(self.kernel.poles)),
            np.repeat(self.kernel.poles, len(self.zones)),
        )
        fast = (
            self.treecode
            if self.has_treecode or len(flat) * len(zone) > BLOCKS.cache_pairs
            else None
        )
        if fast is not None:
            out = fast.potential(flat) if potential else fast.transform(flat)
            # If `kernel.sure`, the treecode already includes the kernel's regular part.
            regular = None if self.kernel.sure else regular
        else:
            every = partial(from_zones, self, zone=zone, shift=shift, potential=potential)
            out = by_rows(
                lambda some: every(some[:, None]).sum(axis=1),
                flat,
                max_rows=max(1, BLOCKS.cache_pairs // len(zone)),
            )
        return (out if regular is None else out + regular_at(self, flat, regular)).reshape(x.shape)

    @cached_property
    def treecode(self) -> Treecode | None:
        """Fast sums of the zones' fields at many points; None if the kernel does not allow them."""
        return Treecode(self) if reaches(self.kernel, self.zones) else None

    @property
    def has_treecode(self) -> bool:
        """Whether `treecode` has been built here, or in the object from which this was copied.

        Then all sums use it, so that a copy and its original agree to the last digit.
        """
        return self.__dict__.get("treecode") is not None or "summed" in self.__dict__

    def __getstate__(self) -> Any:
        kept = super().__getstate__()
        return kept | {"summed": True} if self.has_treecode else kept
