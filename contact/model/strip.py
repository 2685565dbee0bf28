r"""A uniform nominal pressure beyond a strip of half width W/2 about its centre: what it adds to slope and displacement.

Everywhere it would displace the surface by 2 pbar c / E*, c the substrate's compression, or, of a body without a base, by nothing in the
mean of a period; within the strip it does so by its potential, so that beyond it

    (pbar/pi) [Lambda(W/2 + y) - Lambda(W/2 - y)],    y = x - centre,

goes to the right side: (2 pbar/pi) artanh(2y/W) on a half-plane, equation (13) of Goryacheva & Tsukanov (2020).
"""

import math

import numpy as np

from contact.model.line_kernel import SmoothPart
from sie import Array, record

_INSIDE = 1 - 1e-15


@record
class BeyondStrip:
    """Of a unit of nominal pressure, scaled; unit [m]: that of lengths, for the substrate's smooth part and compression."""

    half: float
    period: float
    centre: float
    smooth: SmoothPart
    unit: float
    compression: float | None

    def slope(self, x: Array) -> Array:
        # Zones on their way may pass the border of the strip for a step: the term stays finite there.
        y = x - self.centre
        out = 2 / np.pi * np.arctanh(np.clip(y / self.half, -_INSIDE, _INSIDE))
        if not self.smooth.is_zero:
            potential, unit = self.smooth.potential, self.unit
            out = out + (potential((self.half + y) * unit) - potential((self.half - y) * unit)) / np.pi
        return np.asarray(out)

    def height(self, x: Array) -> Array:
        half, smooth, unit = self.half, self.smooth, self.unit
        # A line load displaces nothing at this distance, or, of a body with a base, far away.
        length = self.period if smooth.scale is None else smooth.scale / unit
        before, after = half + (x - self.centre), half - (x - self.centre)
        total = length * (_entropy(before / length) + _entropy(after / length)) - 2 * half
        if not smooth.is_zero:
            raised = 0.0 if smooth.scale is not None else -float(smooth.potential(np.array(self.period * unit)))
            total = total + (smooth.primitive(before * unit) + smooth.primitive(after * unit)) / unit + 2 * half * raised
        return np.asarray(total / math.pi + (self.compression or 0.0) / unit)


def _entropy(x: Array) -> Array:
    """x ln x, zero at zero."""
    x = np.maximum(x, 0.0)
    return np.asarray(x * np.log(np.where(x > 0, x, 1.0)))
