"""The singular integral equation, as data.

    kappa phi(x) + (1/pi) PV int_zones phi(xi) K(x, xi) dxi = g(x) + sum_k lambda_k C_k(x)

on the zones, with side conditions on the density phi and on the unknown amplitudes lambda_k. Before
anything is solved, the number of unknowns is compared with the number of conditions. The number of
unknowns is the sum of the indices of all zones (see `sie.basis.zones`), plus one for each free end
and one for each unknown amplitude.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sie.basis import inputs
from sie.basis.data import Array, Kept
from sie.basis.kernels import MAKERS, Kernel, Smooth
from sie.basis.weight import Weight
from sie.basis.zones import Zones
from sie.equation.conditions import Condition, EndCondition
from sie.equation.forcing import Forcing


class CountError(ValueError):
    """Raised if the number of side conditions is wrong; the message says the right number.

    Examples
    --------
    >>> import sie
    >>> crack = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: 1 + 0 * x), ())
    >>> try:
    ...     sie.solve(crack, sie.Zones.of([[-1.0, 1.0]], sie.SINGULAR, sie.SINGULAR))
    ... except sie.CountError as error:
    ...     print(str(error)[:31])
    1 side conditions are needed (i
    """


def _forcing(name: str, given: Any) -> Forcing:
    """The given `Forcing`, or a new `Forcing` of the given function of x."""
    if isinstance(given, Forcing):
        return given
    if callable(given) and given is not Forcing:
        return Forcing(given)
    raise ValueError(f"{name} must be a sie.Forcing or a function of x, got {inputs.shown(given)}")


def _kappa(given: Any) -> complex | Array:
    """The checked factor kappa: a number, or an array with one number for each zone."""
    kappa: Any
    kappa = inputs.scalar("kappa", given) if np.ndim(given) == 0 else inputs.scalars("kappa", given)
    if np.any((np.real(kappa) == 0.0) & (np.abs(np.imag(kappa)) >= 1.0)):
        raise ValueError(
            f"kappa = i beta needs -1 < beta < 1 (Dundurs' beta), got {inputs.shown(given)}"
        )
    return kappa  # type: ignore[no-any-return]


def _check_kernel(kernel: Any) -> None:
    """Raise ValueError unless the argument is a `Kernel`, that is, a kernel with a pole."""
    if isinstance(kernel, Kernel):
        return
    if kernel in MAKERS:
        raise ValueError(
            f"the kernel must be the result of sie.{kernel.__name__}(...), got the function "
            "itself: call it"
        )
    if isinstance(kernel, Smooth) or callable(kernel):
        raise ValueError(
            "an equation with a smooth kernel alone is not singular, and is ill-posed: add the "
            "smooth kernel to sie.cauchy()"
        )
    raise ValueError(
        f"the kernel must be a sie.Kernel, such as sie.cauchy(), got {inputs.shown(kernel)}"
    )


@dataclass(frozen=True, eq=False)
class Equation(Kept):
    """A singular integral equation with its side conditions and with conditions on the ends.

    Parameters
    ----------
    kernel : Kernel
        `cauchy()`, `hilbert(period)`, `images(period, neighbours)`, or one of these plus a
        `Smooth`.
    forcing : Forcing or callable
        The right side g; a function of x stands for `Forcing` of it.
    conditions : tuple of Condition
        Side conditions: one for each zone with two singular or two free ends, one less for each
        fixed bounded end, one more for each column. A single condition may be given without a
        tuple.
    columns : tuple of Forcing or callable
        Functions of the right side with unknown amplitudes.
    end_conditions : tuple
        Conditions on the ends alone, as many as there are conditions of unknown value.
    kappa : float, complex or sequence of these
        Factor of the density itself on the left side, one number or one for each zone. Zero is an
        equation of the first kind. A complex kappa, even 0j, makes densities, loads and amplitudes
        complex; ends then are fixed.

    Raises
    ------
    ValueError
        For a kernel without a pole, for columns with jumps, for parts of a wrong type, and for
        conditions on potentials if the right side has logarithms.

    Examples
    --------
    >>> import numpy as np, sie
    >>> hertz = sie.Equation(sie.cauchy(), sie.Forcing(lambda x: x), (sie.Total(np.pi / 2),))
    >>> sie.solve(hertz, sie.Zones.of([[-0.5, 2.0]])).zones.table.round(9).tolist()
    [[-1.0, 1.0]]
    """

    kernel: Kernel
    forcing: Forcing
    conditions: tuple[Condition, ...] = ()
    columns: tuple[Forcing, ...] = ()
    end_conditions: tuple[EndCondition, ...] = ()
    kappa: complex | Sequence[complex] | NDArray[Any] = 0.0

    def __post_init__(self) -> None:
        _check_kernel(self.kernel)
        keep = partial(object.__setattr__, self)
        keep("forcing", _forcing("the right side", self.forcing))
        keep(
            "columns",
            tuple(
                _forcing(f"column {k}", column)
                for k, column in enumerate(inputs.several(self.columns))
            ),
        )
        keep("conditions", inputs.several(self.conditions))
        keep("end_conditions", inputs.several(self.end_conditions))
        keep("kappa", _kappa(self.kappa))
        for condition in self.conditions:
            if not isinstance(condition, Condition):
                raise ValueError(
                    "a side condition must be a sie.Condition, such as sie.Total(1.0), got "
                    f"{inputs.shown(condition)}"
                )
        for end_condition in self.end_conditions:
            if not callable(getattr(end_condition, "residual", None)) or isinstance(
                end_condition, type
            ):
                raise ValueError(
                    "a condition on the ends must be an object with a `residual` method, such as "
                    "sie.TotalWidth(1.0), got "
                    f"{inputs.shown(end_condition)}"
                )
        if any(len(column.jumps) for column in self.columns):
            raise ValueError(
                "a column of unknown amplitude must be smooth: only the right side may have jumps"
            )
        if self.forcing.density_jumps and any(condition.levels for condition in self.conditions):
            raise ValueError(
                "a condition on potentials cannot be combined with declared jumps of the density"
            )

    @cached_property
    def within(self) -> tuple[float, float]:
        """The open interval on which the right side and all `columns` are defined."""
        low, high = zip(*(part.within for part in (self.forcing, *self.columns)), strict=True)
        return max(low), min(high)

    @property
    def second_kind(self) -> bool:
        """Whether kappa differs from zero on at least one zone, or is complex."""
        return bool(np.any(self.kappa)) or np.iscomplexobj(self.kappa)

    def weighted(self, zones: Zones) -> Zones:
        """The zones, with the exponents of the density at their ends that follow from `kappa`.

        Raise ValueError for free ends with a complex kappa.
        """
        if not self.second_kind or not zones.weight.is_half:
            return zones
        kappa = np.asarray(self.kappa)
        if np.iscomplexobj(kappa) and zones.moves.any():
            raise ValueError(
                "with a complex kappa ends cannot be free, since the density oscillates next to "
                "the ends and has no sign: declare each end as sie.SINGULAR or sie.BOUNDED"
            )
        if np.iscomplexobj(kappa) and zones.have_values:
            raise ValueError("with a complex kappa the density cannot have a given value at an end")
        if kappa.ndim and kappa.shape != (len(zones),):
            raise ValueError(
                f"kappa has {len(kappa)} values for {len(zones)} zones: give one number, or one "
                "for each zone"
            )
        return replace(zones, weight=Weight(np.broadcast_to(kappa, len(zones)).copy()))

    @property
    def grows(self) -> bool:
        """Whether modes are added until the kernel and the columns of the equation are resolved.

        This is so for columns with an unknown number of modes, and for a user's regular kernel.
        """
        return any(column.resolution.modes is None for column in self.columns) or self.kernel.grows

    @property
    def open_condition(self) -> int | None:
        """Index of the side condition whose value is unknown; None if all values are known.

        A condition on the ends determines its value.
        """
        return next((k for k, condition in enumerate(self.conditions) if condition.open), None)

    def check_count(self, zones: Zones) -> None:
        """Raise CountError if there are too few or too many side conditions for the zones.

        Raise ValueError if the zones together are as wide as a period or wider, so that the last
        one reaches the image of the first.
        """
        images = [shift for shift in self.kernel.poles if shift > 0]
        if images and not zones.b[-1] - zones.a[0] < min(images):
            raise ValueError(
                f"the zones extend over {zones.b[-1] - zones.a[0]:.6g}, but must extend over less "
                f"than the period {min(images):.6g}"
            )
        first = int(zones.solved[0])
        ends = [*zones.left[first:], *zones.right[first:]]
        # Ends share a few `End` objects, so counting the uses of each object is faster than a sum
        # over all ends.
        kinds = {id(end): end for end in ends}
        surplus = sum(
            count * kinds[one].surplus for one, count in Counter(map(id, ends)).items()
        ) - len(zones.solved)
        if zones.central:
            surplus += (
                1 - zones.left[first].surplus
            )  # by symmetry, only the right end of the zone about the centre counts
        opened = sum(condition.open for condition in self.conditions)
        unknowns = surplus + len(self.columns) + opened
        given = sum(condition.count(zones) for condition in self.conditions) + len(
            self.end_conditions
        )
        names = ", ".join(str(c) for c in (*self.conditions, *self.end_conditions)) or "none"
        if opened > 1 or opened != len(self.end_conditions):
            raise CountError(
                f"side conditions with an unknown value: {opened}, conditions on the ends: "
                f"{len(self.end_conditions)}; give one of each, or none of either"
            )
        if given != unknowns:
            what = (
                f"{unknowns - given} more needed"
                if given < unknowns
                else f"{given - unknowns} too many"
            )
            raise CountError(
                f"{unknowns} side conditions are needed (index {surplus}, {len(self.columns)} "
                "unknown amplitudes, "
                f"{opened} unknown values) but {given} are given ({names}): {what}"
                + (
                    "; add columns of unknown amplitude, or make some bounded ends singular"
                    if unknowns < 0
                    else ""
                )
            )
