r"""`Operator`: how a pressure displaces the surface, from the interaction and the substrate.

All parts of the operator follow from the symbol L of the substrate (l is the period, r = x - xi):

    kernel        of a line load: 1/r + int (L - 1) sin(qr) dq (contact.model.line_load), alone or
                  with the images of a strip; of all periods: Hilbert's kernel plus
                  sum (L_n - 1) sin(2 pi n r / l) 2 pi / l (contact.model.symbols)
    grid          the multiplier 2 L / (E* q)
    full contact  p_q = -E* q f_q / 2 L(q) + mean
    gaps          the kernel for the slope of the gap has the symbol 1/L
    half-plane    u is harmonic below the surface: contact only grows with the load, and a flat
                  top touches as a whole

An interaction of a user may give its own kernel for the pressure and the certificate. Without the
symbol of that kernel there is no inverse operator: neither full contact nor the gap formulation is
offered.

A uniform nominal pressure pbar outside a strip of half width W/2 adds a term to the right side. Its
displacement is that of pbar on the whole surface minus that of pbar inside the strip. The first
part is the constant 2 pbar c / E*, with c the compression of the substrate, or 0 without a base.
The second part follows from the potential Lambda of a line load. So the term of the equation for
the slope is, with y = x - centre,

    (pbar/pi) [Lambda(W/2 + y) - Lambda(W/2 - y)],

that is (2 pbar/pi) artanh(2y/W) on a half-plane, equation (13) of Goryacheva & Tsukanov (2020).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial

import numpy as np
import scipy.fft
import scipy.special

import sie
from contact.errors import SceneError
from contact.model.interactions.base import Interaction, Scaled
from contact.model.line_load import OPTIONS as LINE_LOADS
from contact.model.line_load import SmoothPart
from contact.model.plugin_checks.forms import AuthorMethod
from contact.model.profiles.noise import ROUND_OFF
from contact.model.substrates.base import Substrate
from contact.model.symbols import OPTIONS as SYMBOLS
from contact.model.symbols import checked, excess, kernel_of
from sie import Array, record

Potential = Callable[[Array, Array], Array]
Symbol = Callable[[Array], Array]
# Type of functions that return the mean of a smooth potential over grid cells. Their arguments are
# the distances x - xi [m] and the width of a cell [m].
Rest = Callable[[Array, float], Array]


@dataclass(frozen=True)
class OperatorOptions:
    """Options for averaging a kernel over the cells of a grid."""

    # Distance from the source, in cell widths, up to which the kernel is averaged over a cell.
    near_cells: float = 4.5


_OPTIONS = OperatorOptions()


@record
class Operator(sie.Kept):
    """The elastic operator: the effect of a pressure on the surface, for an interaction and a
    substrate.

    period: the period of the solution [m]; None for a contact without a period.
    """

    interaction: Interaction
    substrate: Substrate
    period: float | None

    @property
    def is_periodic(self) -> bool:
        """Whether the contact is periodic: the pressure of all periods acts."""
        return self.period is not None and not self.interaction.strip

    @property
    def is_own(self) -> bool:
        """Whether the interaction gives its own kernel or symbol and does not use the substrate."""
        return self._overrides("kernel") or self._overrides("symbol")

    def _overrides(self, name: str) -> bool:
        """Whether the interaction's class overrides the method `name` of `Interaction`."""
        return getattr(type(self.interaction), name) is not getattr(Interaction, name)

    @cached_property
    def symbol(self) -> Symbol | None:
        """The symbol L(q): the compliance of the surface relative to that of a half-plane, at
        wavenumber q [1/m]. It is None if the interaction gives a kernel without a symbol.
        """
        if not self.is_own:
            return self.substrate.symbol
        return self.interaction.symbol if self._overrides("symbol") else None

    @property
    def _named(self) -> str:
        return "interaction" if self.is_own else "substrate"

    @cached_property
    def excess(self) -> Array | None:
        """L_n - 1, with L_n the symbol at the harmonic n of the period, up to the last value that
        is not zero. It is None if the contact is not periodic, or if there is no symbol.
        """
        if not self.is_periodic or self.symbol is None:
            return None
        assert self.period is not None
        return excess(self.symbol, self.period, self._named)

    @property
    def has_inverse(self) -> bool:
        """Whether the pressure can be computed from a given displacement.

        If so, full contact and the gap formulation are available.
        """
        return self.excess is not None

    @cached_property
    def inverse_excess(self) -> Array | None:
        """1 / L_n - 1 for the inverse operator, with L_n the symbol at the harmonic n of the
        period. It is None if there is no inverse.
        """
        return None if self.excess is None else np.asarray(-self.excess / (1 + self.excess))

    @property
    def is_half_plane(self) -> bool:
        """Whether the symbol L is 1 at all wavenumbers and a uniform pressure causes no
        displacement.
        """
        return self.excess is not None and len(self.excess) == 0 and not self.compression

    @cached_property
    def is_plain(self) -> bool:
        """Whether the kernel is that of line loads on a half-plane, without a smooth part."""
        if self.is_own:
            return self.interaction.strip or self.rest is None
        return self.compression is None and (
            self.is_half_plane if self.is_periodic else self.smooth_part.is_zero
        )

    @property
    def compression(self) -> float | None:
        """The length c [m]: a uniform pressure p displaces the surface by 2 p c / E*.
        None if the substrate does not define this displacement.
        """
        return None if self.is_own else self.substrate.compression

    @property
    def smooth_part(self) -> SmoothPart:
        """Smooth part of the kernel of a line load on the substrate: the kernel minus 1/r, with r
        the distance from the load.
        """
        return self.substrate.smooth_part

    @property
    def has_approach(self) -> bool:
        return (
            self.interaction.needs_period
            or self.interaction.datum is not None
            or self.compression is not None
        )

    @property
    def datum(self) -> float | None:
        """Distance [m] from a line load at which the surface is not displaced. None if no such
        distance is given; the approach of a contact without a period is then undefined.

        Only the kernel of a line load uses the datum: the kernel for all periods does not need it.
        """
        return self.smooth_part.scale if self.compression is not None else self.interaction.datum

    def inverse_kernel(self, unit: float) -> sie.Kernel:
        """The kernel of the inverse operator, in scaled lengths, for equations in the slope of the
        gap. Its symbol is 1 / L, with L the symbol of the operator.
        """
        assert self.period is not None and self.inverse_excess is not None
        return kernel_of(self.inverse_excess, self.period / unit)

    def kernel(self, unit: float) -> sie.Kernel:
        """The kernel of the interaction on the substrate, in scaled lengths.

        If all periods act, the mean of the kernel's potential comes from the compression only.
        """
        period = None if self.period is None else self.period / unit
        if self.is_own:
            return self._own_kernel(period, unit)
        if not self.is_periodic:
            return self._line_kernel(period, unit)
        assert self.excess is not None and period is not None
        kernel = kernel_of(self.excess, period)
        if not self.compression:
            return kernel
        assert kernel.regular_potential is not None
        return replace(
            kernel,
            regular_potential=partial(
                _less_constant, kernel.regular_potential, np.pi * self.compression / unit / period
            ),
        )

    def _line_kernel(self, period: float | None, unit: float) -> sie.Kernel:
        """The kernel of a line load: 1/r plus a smooth part, repeated for the images of a strip.

        The potential vanishes at the datum, or far away on a body with a base.
        """
        smooth, own = self.smooth_part, self.compression is not None
        shifts = 0 if period is None else self.interaction.neighbours
        datum = self.datum if period is None or own else self.period
        scaled = 1.0 if datum is None else datum / unit
        plain = (
            sie.images(period, shifts, datum=scaled) if period is not None else sie.cauchy(scaled)
        )
        if smooth.is_zero:
            return plain
        raised = partial(_plus_constant, smooth.potential, self._datum_constant(datum))
        potential = partial(_lines, raised, plain.poles, unit, 1.0)
        value = partial(_lines, smooth.value, plain.poles, unit, unit)
        return plain + sie.Smooth(value, potential, of_lag=True, length=smooth.length / unit)

    def _datum_constant(self, datum: float | None) -> float:
        """Constant that makes the potential of a line load zero at the distance `datum` [m].

        It is 0 on a body with a base, whose potential vanishes far away.
        """
        return (
            0.0
            if self.compression is not None or datum is None
            else -float(self.smooth_part.potential(np.array(datum)))
        )

    def _own_kernel(self, period: float | None, unit: float) -> sie.Kernel:
        if self._overrides("kernel"):
            kernel = self.interaction.kernel(period, unit)
        elif period is not None and self.excess is not None:
            kernel = kernel_of(self.excess, period)
        else:
            raise SceneError(
                "an interaction with a symbol and without a kernel needs a periodic profile and no "
                "strip: give the interaction a kernel",
                "interaction",
            )
        if not isinstance(kernel, sie.Kernel):
            raise SceneError.of(
                "interaction.kernel(period, unit)",
                kernel,
                "a sie.Kernel, such as sie.hilbert(period) + sie.Smooth(...)",
            )
        # The kernel depends on the difference x - xi only, which was checked when the scene was
        # made.
        kernel = replace(kernel, of_lag=True)
        if not self.is_periodic or kernel.regular_potential is None or self.is_half_plane:
            return kernel
        assert period is not None
        # The potential of Hilbert's kernel has mean zero over a period. The mean of the rest is
        # subtracted, so that the whole potential has mean zero.
        mean = float(
            _smooth_rest(
                kernel, period, period * (np.arange(SYMBOLS.harmonics) + 0.5) / SYMBOLS.harmonics
            ).mean()
        )
        return replace(
            kernel, regular_potential=partial(_less_constant, kernel.regular_potential, mean)
        )

    @property
    def own_columns(self) -> bool:
        """Whether the interaction defines its own terms of unknown amplitude on the right side."""
        return self._overrides("columns") or self._overrides("placed_columns")

    def columns(self, centre: float, unit: float, scaled: Scaled) -> tuple[sie.Forcing, ...]:
        """Terms of unknown amplitude on the right side of the integral equation, in scaled lengths.

        centre: scaled position of the middle of the strip.
        """
        interaction = self.interaction
        period = None if self.period is None else self.period / unit
        if self.is_own or self.own_columns or not interaction.strip:
            method = AuthorMethod("interaction.columns(period, centre)", "interaction")
            return method.rows(sie.Forcing, interaction.placed_columns, period, centre, scaled)
        assert period is not None
        half = 0.5 * (2 * interaction.neighbours + 1) * period
        beyond = BeyondStrip(half, period, centre, self.smooth_part, unit, self.compression)
        return (
            sie.Forcing(
                beyond.slope, beyond.height, resolution=sie.Resolution(smooth_between=True)
            ),
        )

    def multiplier(self, q: Array) -> Array:
        """The symbol L(q) (relative compliance of the surface) at the wavenumbers q [1/m].
        q are the first harmonics of the period. Without a declared symbol, the values are computed
        from the kernel.
        """
        assert self.period is not None
        if self.symbol is not None:
            return checked(self.symbol, q, self._named)
        rest = self.rest
        if rest is None:
            return np.ones_like(q)
        places = SYMBOLS.harmonics * -(-2 * (len(q) + 1) // SYMBOLS.harmonics)
        values = rest(np.asarray(self.period / places * np.arange(places)), 0.0)
        n = np.arange(1, len(q) + 1)
        found = 1.0 - q / np.pi * (self.period / places) * scipy.fft.rfft(values).real[n]
        return np.asarray(np.maximum(found, ROUND_OFF), dtype=np.float64)

    @cached_property
    def rest(self) -> Rest | None:
        """The function that gives the smooth part of the potential, averaged over grid cells.

        The smooth part is the potential at x - xi [m] minus that of line loads on a half-plane.
        None if the smooth part is zero, and for a strip.
        """
        if self.interaction.strip or (not self.is_own and self.is_plain):
            return None
        if self.period is None:
            kernel = self.kernel(1.0)
            if self.is_own:
                return None if kernel.regular is None else partial(_rest, kernel, None)
            return partial(
                _cells, self.smooth_part.primitive, (0.0,), self._datum_constant(self.datum)
            )
        if self.is_half_plane:
            return None
        kernel = self.kernel(1.0)
        lag = self.period * (np.arange(SYMBOLS.harmonics) + 0.5) / SYMBOLS.harmonics
        return (
            partial(_rest, kernel, self.period)
            if float(np.abs(_smooth_rest(kernel, self.period, lag)).max()) > ROUND_OFF
            else None
        )

    @cached_property
    def strip_rest(self) -> Rest | None:
        """The function `rest` for a profile that is cut to one strip, up to a constant.

        None on a half-plane, and if the interaction gives its own kernel.
        """
        if self.is_own or self.smooth_part.is_zero:
            return None
        return partial(_cells, self.smooth_part.primitive, self.kernel(1.0).poles, 0.0)


def _lines(
    of: Callable[[Array], Array],
    poles: tuple[float, ...],
    unit: float,
    factor: float,
    x: Array,
    xi: Array,
) -> Array:
    """`factor` times the sum of the function `of` at (x - xi - s) * `unit` [m] over all poles s."""
    lag = x - xi
    total = sum((of((lag - pole) * unit) for pole in poles), np.zeros(np.shape(lag)))
    return np.asarray(factor * total)


def _plus_constant(of: Callable[[Array], Array], constant: float, r: Array) -> Array:
    """The sum of the function `of` at the distance r and a constant."""
    return np.asarray(of(r) + constant)


def _cells(
    primitive: Callable[[Array], Array],
    poles: tuple[float, ...],
    raised: float,
    lag: Array,
    width: float,
) -> Array:
    """Mean of a potential over a cell around the distance `lag` [m], summed over all images.
    It is computed from the primitive of the potential.

    Cells may be wider than the length over which the potential varies.
    """
    rise = sum(
        (primitive(lag - s + 0.5 * width) - primitive(lag - s - 0.5 * width) for s in poles),
        np.zeros(len(lag)),
    )
    return np.asarray(rise / width + raised)


def _less_constant(potential: Potential, by: float, x: Array, xi: Array) -> Array:
    """A potential minus the constant `by`."""
    return np.asarray(potential(x, xi) - by)


def _rest(kernel: sie.Kernel, period: float | None, lag: Array, width: float = 0.0) -> Array:
    """The potential of a kernel minus that of line loads on a half-plane, at the distances
    `lag`. Near the source, this difference is averaged over cells of the width `width`.
    """
    found = _smooth_rest(kernel, period, lag)
    near = np.flatnonzero(np.abs(lag) < _OPTIONS.near_cells * width)
    if len(near):
        # The smooth part may have a singularity nearer to the surface than the width of a cell.
        # Then the smooth part varies like a logarithm in the cell, and its mean differs from its
        # value at the middle.
        places, weights = _crowded_nodes()
        found[near] = (
            _smooth_rest(kernel, period, (lag[near][:, None] + width * places).ravel()).reshape(
                len(near), -1
            )
            @ weights
        )
    return found


def _smooth_rest(kernel: sie.Kernel, period: float | None, lag: Array) -> Array:
    if period is None:
        return smooth_potential(kernel, lag)
    lag = sie.nearest_image(lag, 0.0, period)
    return np.asarray(smooth_potential(kernel, lag) - smooth_potential(sie.hilbert(period), lag))


@cache
def _crowded_nodes() -> tuple[Array, Array]:
    """Quadrature nodes and weights on (-1/2, 1/2); the nodes are dense near 0."""
    node, weight = np.polynomial.legendre.leggauss(LINE_LOADS.nodes)
    # The cube of `u` makes the nodes dense at the middle of the cell, where the potential may vary
    # as a logarithm.
    u = 0.5 * (1 + node)
    places, weights = 0.5 * u**3, 0.75 * weight * u**2
    return np.concatenate((-places, places)), np.concatenate((weights, weights))


def smooth_potential(kernel: sie.Kernel, lag: Array) -> Array:
    """The kernel's potential Lambda(lag) without its logarithm.
    The logarithm is ln|lag| with a period, and ln|lag / datum| without a period.
    """
    out = np.zeros(np.shape(lag))
    if kernel.period is not None:
        out -= np.log(kernel.datum)
    for pole in kernel.poles[1:]:
        out += np.log(np.abs(lag - pole) / kernel.datum)
    if kernel.regular_potential is not None:
        out += kernel.regular_potential(np.asarray(lag), np.zeros(1))
    return out


@record
class BeyondStrip:
    """Term of the right side for a unit nominal pressure outside a strip, in scaled lengths.

    half: half width of the strip with its copies. unit: unit of length [m], for the smooth part and
    the compression.
    """

    half: float
    period: float
    centre: float
    smooth: SmoothPart
    unit: float
    compression: float | None

    def slope(self, x: Array) -> Array:
        # During Newton steps, zones may extend over the border of the strip. The clip keeps the
        # arctanh finite at such places.
        y, inside = x - self.centre, 1 - 4 * np.finfo(np.float64).eps
        out = 2 / np.pi * np.arctanh(np.clip(y / self.half, -inside, inside))
        if not self.smooth.is_zero:
            potential, unit = self.smooth.potential, self.unit
            out = (
                out
                + (potential((self.half + y) * unit) - potential((self.half - y) * unit)) / np.pi
            )
        return np.asarray(out)

    def height(self, x: Array) -> Array:
        half, smooth, unit = self.half, self.smooth, self.unit
        # `length` is the distance at which a line load causes no displacement. It is the period or,
        # on a body with a base, the length `smooth.scale`.
        length = self.period if smooth.scale is None else smooth.scale / unit
        before, after = half + (x - self.centre), half - (x - self.centre)
        total = length * (_x_log_x(before / length) + _x_log_x(after / length)) - 2 * half
        if not smooth.is_zero:
            raised = (
                0.0
                if smooth.scale is not None
                else -float(smooth.potential(np.array(self.period * unit)))
            )
            total = (
                total
                + (smooth.primitive(before * unit) + smooth.primitive(after * unit)) / unit
                + 2 * half * raised
            )
        return np.asarray(total / math.pi + (self.compression or 0.0) / unit)


def _x_log_x(x: Array) -> Array:
    """x ln x for x > 0, and 0 for x <= 0."""
    x = np.maximum(x, 0.0)
    return np.asarray(scipy.special.xlogy(x, x))
