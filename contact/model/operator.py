r"""The elastic operator of a scene: what the pressure does to the surface, composed of the
interaction and the substrate.

The symbol of the substrate is the one source of all of it:

    kernel        of a line load, 1/r + int (L - 1) sin(qr) dq (contact.model.symbols), alone or with the images of a strip;
                  of all periods, Hilbert's and sum (L_n - 1) sin(2 pi n r / l) 2 pi / l
                  (contact.model.symbols)
    grid          the multiplier 2 L / (E* q)
    full contact  p_q = -E* q f_q / 2 L(q) + mean
    by the gaps   the slope of the gap as the unknown, under the symbol 1/L: sum (1/L_n - 1) sin(2 pi n r / l) 2 pi / l beside Hilbert's
    a maximum     u is harmonic below the surface: half-plane sources and nothing else; contact only grows with the load, and a flat
                  top is in contact as a whole

An interaction of someone's own may give a kernel itself, for zones, their pressure and what is
certified; without the symbol of that kernel the operator has no inverse: neither full contact nor
the gap formulation is offered.

A uniform nominal pressure beyond a strip of half width W/2 about its centre would everywhere
displace the surface by 2 pbar c / E*, c the substrate's compression, or, of a body without a base,
by nothing in the mean of a period; within the strip it does so by its potential, so that beyond it

    (pbar/pi) [Lambda(W/2 + y) - Lambda(W/2 - y)],    y = x - centre,

goes to the right side: (2 pbar/pi) artanh(2y/W) on a half-plane, equation (13) of Goryacheva &
Tsukanov (2020).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache, cached_property, partial

import numpy as np
import scipy.fft
import scipy.special

import sie
from contact.errors import SceneError
from contact.model.interactions.base import Interaction, Scaled
from contact.model.parts import Told
from contact.model.substrates.base import Substrate
from contact.model.symbols import SmoothPart, checked, excess, kernel_of
from sie import Array, record

Potential = Callable[[Array, Array], Array]
Symbol = Callable[[Array], Array]
# Of lags and the width of a cell.
Rest = Callable[[Array, float], Array]

# Places over a period at which a kernel is compared with Hilbert's, and what rounding makes of no
# difference.
_PLACES = 4096
_NOTHING = 1e-13
# Of cells nearer to a source than some widths the mean is taken: over panels that are halved
# towards the middle, by some nodes each.
_WITHIN = 4.5
_PANELS = 32
_PER_PANEL = 6
# The smallest compliance over the half-plane's.
_SOFTEST = 1e-9


@record
class Operator(sie.Kept):
    """The operator of an interaction on a substrate under a period [m] of the solution, None where
    nothing repeats.
    """

    interaction: Interaction
    substrate: Substrate
    period: float | None

    @property
    def is_periodic(self) -> bool:
        """Whether all periods act, so that harmonics stay harmonics."""
        return self.period is not None and not self.interaction.strip

    @property
    def is_own(self) -> bool:
        """Whether the interaction gives a kernel, or the symbol of one, and asks nothing of the
        substrate.
        """
        return self._gives("kernel") or self._gives("symbol")

    def _gives(self, name: str) -> bool:
        """Whether the interaction has a method of its own of that name."""
        return getattr(type(self.interaction), name) is not getattr(Interaction, name)

    @cached_property
    def symbol(self) -> Symbol | None:
        """L of q [1/m]; None of an interaction's own kernel without one."""
        if not self.is_own:
            return self.substrate.symbol
        return self.interaction.symbol if self._gives("symbol") else None

    @property
    def _named(self) -> str:
        return "interaction" if self.is_own else "substrate"

    @cached_property
    def excess(self) -> Array | None:
        """L_n - 1 of the harmonics of the period, as far as it is not zero; None without a symbol."""
        if not self.is_periodic or self.symbol is None:
            return None
        assert self.period is not None
        return excess(self.symbol, self.period, self._named)

    @property
    def has_inverse(self) -> bool:
        """Whether the pressure of a given displacement is known: full contact, and the gap
        formulation.
        """
        return self.excess is not None

    @cached_property
    def inverse_excess(self) -> Array | None:
        """1 / L_n - 1, the same of the inverse operator."""
        return None if self.excess is None else np.asarray(-self.excess / (1 + self.excess))

    @property
    def is_half_plane(self) -> bool:
        """Whether L = 1, and the displacement is that of a half-plane."""
        return self.excess is not None and len(self.excess) == 0 and not self.compression

    @cached_property
    def is_plain(self) -> bool:
        """Whether there is nothing beyond half-plane sources."""
        if self.is_own:
            return self.interaction.strip or self.rest is None
        return self.compression is None and (
            self.is_half_plane if self.is_periodic else self.smooth_part.is_zero
        )

    @property
    def compression(self) -> float | None:
        """By how much a uniform pressure p displaces the surface, over 2 p / E* [m]; None where
        that is not counted, or not finite.
        """
        return None if self.is_own else self.substrate.compression

    # Displacements and what they count from
    # ---------------------------------------------------------------------------
    @property
    def smooth_part(self) -> SmoothPart:
        """Of a line load on the substrate."""
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
        """The length in the logarithm of a line load's displacement, where nothing repeats [m];
        None where there is no approach.
        """
        return self.smooth_part.scale if self.compression is not None else self.interaction.datum

    def inverse_kernel(self, unit: float) -> sie.Kernel:
        """The kernel of symbol 1 / L in scaled lengths: what the slope of the gap is to the
        pressure, as the pressure to that.
        """
        assert self.period is not None and self.inverse_excess is not None
        return kernel_of(self.inverse_excess, self.period / unit)

    def kernel(self, unit: float) -> sie.Kernel:
        """The kernel in scaled lengths; that of all periods with a potential that has no mean but
        that of the compression.
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
                _lowered, kernel.regular_potential, np.pi * self.compression / unit / period
            ),
        )

    def _line_kernel(self, period: float | None, unit: float) -> sie.Kernel:
        """1/r and the smooth part of a line load, with the images of a strip; its length vanishes
        far away, or in the datum.
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
        potential = partial(_lines, smooth.potential, plain.poles, unit, 1.0, self._raised(datum))
        value = partial(_lines, smooth.value, plain.poles, unit, unit, 0.0)
        return plain + sie.Smooth(value, potential, of_lag=True, length=smooth.length / unit)

    def _raised(self, datum: float | None) -> float:
        """What makes the potential of a line load vanish in the datum [m], or far away from a body
        with a base.
        """
        return (
            0.0
            if self.compression is not None or datum is None
            else -float(self.smooth_part.potential(np.array(datum)))
        )

    def _own_kernel(self, period: float | None, unit: float) -> sie.Kernel:
        if self._gives("kernel"):
            kernel = self.interaction.kernel(period, unit)
        elif period is not None and self.excess is not None:
            kernel = kernel_of(self.excess, period)
        else:
            raise SceneError(
                "an interaction with a symbol and no kernel needs a period, and no strip",
                "interaction",
            )
        if not isinstance(kernel, sie.Kernel):
            raise SceneError.of(
                "interaction.kernel(period, unit)",
                kernel,
                "a sie.Kernel, such as sie.hilbert(period) + sie.Smooth(...)",
            )
        # Of the lag alone: that is held when a scene is made.
        kernel = replace(kernel, of_lag=True)
        if not self.is_periodic or kernel.regular_potential is None or self.is_half_plane:
            return kernel
        assert period is not None
        # Over a period Hilbert's has no mean.
        mean = float(_beyond(kernel, period, period * (np.arange(_PLACES) + 0.5) / _PLACES).mean())
        return replace(kernel, regular_potential=partial(_lowered, kernel.regular_potential, mean))

    @property
    def own_columns(self) -> bool:
        """Whether the interaction gives columns of its own, of which nothing is known."""
        return self._gives("columns") or self._gives("placed_columns")

    def columns(self, centre: float, unit: float, scaled: Scaled) -> tuple[sie.Forcing, ...]:
        """Terms of the right side with an unknown amplitude, scaled, about the centre of the strip."""
        interaction = self.interaction
        period = None if self.period is None else self.period / unit
        if self.is_own or self.own_columns or not interaction.strip:
            told = Told("interaction.columns(period, centre)", "interaction")
            return told.rows(sie.Forcing, interaction.placed_columns, period, centre, scaled)
        assert period is not None
        half = 0.5 * (2 * interaction.neighbours + 1) * period
        beyond = BeyondStrip(half, period, centre, self.smooth_part, unit, self.compression)
        return (
            sie.Forcing(
                beyond.slope, beyond.height, resolution=sie.Resolution(smooth_between=True)
            ),
        )

    # For grids
    # --------------------------------------------------------------------------------------------------------
    def multiplier(self, q: Array) -> Array:
        """L of the first harmonics q of the period: declared, or found from the kernel."""
        assert self.period is not None
        if self.symbol is not None:
            return checked(self.symbol, q, self._named)
        rest = self.rest
        if rest is None:
            return np.ones_like(q)
        places = _PLACES * -(-2 * (len(q) + 1) // _PLACES)
        values = rest(np.asarray(self.period / places * np.arange(places)), 0.0)
        n = np.arange(1, len(q) + 1)
        found = 1.0 - q / np.pi * (self.period / places) * scipy.fft.rfft(values).real[n]
        return np.asarray(np.maximum(found, _SOFTEST), dtype=np.float64)

    @cached_property
    def rest(self) -> Rest | None:
        """Potential of the lag x - xi [m], less that of half-plane sources, in the mean of cells of
        a width [m]; None where there is nothing else, or only a strip.
        """
        if self.interaction.strip or (not self.is_own and self.is_plain):
            return None
        if self.period is None:
            kernel = self.kernel(1.0)
            if self.is_own:
                return None if kernel.regular is None else partial(_rest, kernel, None)
            return partial(_cells, self.smooth_part.primitive, (0.0,), self._raised(self.datum))
        if self.is_half_plane:
            return None
        kernel = self.kernel(1.0)
        lag = self.period * (np.arange(_PLACES) + 0.5) / _PLACES
        return (
            partial(_rest, kernel, self.period)
            if float(np.abs(_beyond(kernel, self.period, lag)).max()) > _NOTHING
            else None
        )

    @cached_property
    def strip_rest(self) -> Rest | None:
        """The same of a strip and its images, up to a constant; None on a half-plane."""
        if self.is_own or self.smooth_part.is_zero:
            return None
        return partial(_cells, self.smooth_part.primitive, self.kernel(1.0).poles, 0.0)


def _lines(
    of: Callable[[Array], Array],
    poles: tuple[float, ...],
    unit: float,
    factor: float,
    raised: float,
    x: Array,
    xi: Array,
) -> Array:
    """A function of x - xi - s [m] summed over the poles s, times a factor and raised by a constant
    for each.
    """
    lag = x - xi
    total = sum((of((lag - pole) * unit) for pole in poles), np.zeros(np.shape(lag)))
    return np.asarray(factor * total + len(poles) * raised)


def _cells(
    primitive: Callable[[Array], Array],
    poles: tuple[float, ...],
    raised: float,
    lag: Array,
    width: float,
) -> Array:
    """The mean of a potential over a cell about the lag [m], by its primitive, summed over images:
    cells may be wider than it varies.
    """
    rise = sum(
        (primitive(lag - s + 0.5 * width) - primitive(lag - s - 0.5 * width) for s in poles),
        np.zeros(len(lag)),
    )
    return np.asarray(rise / width + raised)


def _lowered(potential: Potential, by: float, x: Array, xi: Array) -> Array:
    """A potential less a constant."""
    return np.asarray(potential(x, xi) - by)


def _rest(kernel: sie.Kernel, period: float | None, lag: Array, width: float = 0.0) -> Array:
    """The potential of a kernel less the logarithm of its lag; with a period, less all of
    Hilbert's: at the lags, or its means over cells of a width about them.
    """
    found = _beyond(kernel, period, lag)
    near = np.flatnonzero(np.abs(lag) < _WITHIN * width)
    if len(near):
        # Of a source at a depth below a cell's width, the middle of the cell tells nothing.
        places, weights = _graded()
        found[near] = (
            _beyond(kernel, period, (lag[near][:, None] + width * places).ravel()).reshape(
                len(near), -1
            )
            @ weights
        )
    return found


def _beyond(kernel: sie.Kernel, period: float | None, lag: Array) -> Array:
    if period is None:
        return smooth_potential(kernel, lag)
    lag = sie.nearest_image(lag, 0.0, period)
    return np.asarray(smooth_potential(kernel, lag) - smooth_potential(sie.hilbert(period), lag))


@cache
def _graded() -> tuple[Array, Array]:
    """Places in a cell about 0 of width 1, closer and closer towards its middle, and their weights."""
    node, weight = np.polynomial.legendre.leggauss(_PER_PANEL)
    ends = np.append(0.5 ** np.arange(1.0, _PANELS + 1), 0.0)
    half, middle = 0.5 * (ends[:-1] - ends[1:])[:, None], 0.5 * (ends[:-1] + ends[1:])[:, None]
    places, weights = (middle + half * node).ravel(), (half * weight).ravel()
    return np.concatenate((-places, places)), np.concatenate((weights, weights))


def smooth_potential(kernel: sie.Kernel, lag: Array) -> Array:
    """Lambda(lag) - ln|lag|, less the constant of the datum where that is one of a lone body."""
    out = np.zeros(np.shape(lag))
    if kernel.period is not None:
        out -= np.log(kernel.datum)
    for pole in kernel.poles[1:]:
        out += np.log(np.abs(lag - pole) / kernel.datum)
    if kernel.regular_potential is not None:
        out += kernel.regular_potential(np.asarray(lag), np.zeros(1))
    return out


_INSIDE = 1 - 1e-15


@record
class BeyondStrip:
    """Of a unit of nominal pressure, scaled; unit [m]: that of lengths, for the substrate's smooth
    part and compression.
    """

    half: float
    period: float
    centre: float
    smooth: SmoothPart
    unit: float
    compression: float | None

    def slope(self, x: Array) -> Array:
        # Zones on their way may pass the border of the strip for a step: the term stays finite
        # there.
        y = x - self.centre
        out = 2 / np.pi * np.arctanh(np.clip(y / self.half, -_INSIDE, _INSIDE))
        if not self.smooth.is_zero:
            potential, unit = self.smooth.potential, self.unit
            out = (
                out
                + (potential((self.half + y) * unit) - potential((self.half - y) * unit)) / np.pi
            )
        return np.asarray(out)

    def height(self, x: Array) -> Array:
        half, smooth, unit = self.half, self.smooth, self.unit
        # A line load displaces nothing at this distance, or, of a body with a base, far away.
        length = self.period if smooth.scale is None else smooth.scale / unit
        before, after = half + (x - self.centre), half - (x - self.centre)
        total = length * (_entropy(before / length) + _entropy(after / length)) - 2 * half
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


def _entropy(x: Array) -> Array:
    """x ln x, zero at zero."""
    x = np.maximum(x, 0.0)
    return np.asarray(scipy.special.xlogy(x, x))
