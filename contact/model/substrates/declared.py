"""Whether what a substrate of someone's own gives is the symbol of an elastic body.

Looked at once, when a scene is made: the symbol must be real, finite and of the shape of q from waves of the length of a planet to those of
an atom, above zero, 1 for short waves, and for long ones as the `compression` says. What is wrong is named.
"""

from math import isfinite
from numbers import Real
from typing import Any

import numpy as np

from contact.errors import SceneError
from contact.model.line_kernel import WAVES
from contact.model.spectrum import checked
from contact.model.substrates.base import Substrate

# How near 1 the symbol comes for the shortest waves; how near its limit for the longest; and what is no limit above zero.
_SHORT, _LONG, _VANISHES = 1e-13, 1e-6, 1e-6
# Where L - 1 is still known to some digits; no power of the wave falls faster there than exponentials do.
_SEEN, _SLOWEST = 1e-11, -8.0


def require_body(substrate: Substrate) -> None:
    """SceneError that names the first claim of the substrate that does not hold."""
    values = checked(substrate.symbol, WAVES, "substrate")
    checked(substrate.symbol, WAVES[: 2 * (len(WAVES) // 2)].reshape(2, -1), "substrate")
    again = checked(substrate.symbol, WAVES[::-1], "substrate")[::-1]
    if not np.allclose(again, values, rtol=1e-12, atol=0):
        raise SceneError("substrate.symbol(q) depends on the other waves of q: it must be taken element by element", "substrate")
    _require_fast(values)
    if not abs(values[-1] - 1) < _SHORT:
        raise SceneError.of(
            "substrate.symbol(q)", float(values[-1]), f"1 for short waves, as it is not at q = {WAVES[-1]:.0e} 1/m: what is solved is the "
            "body's compliance over that of a half-plane of its own surface's modulus E_star",
        )
    compression = _compression(substrate)
    long, wave = float(values[0]), float(WAVES[0])
    if compression is None:
        if long < _VANISHES:
            raise SceneError.of(
                "substrate.compression", None, f"given, since the symbol vanishes for long waves (L = {long:.3g} at q = {wave:.0e} 1/m): "
                "the body has a base, and the limit of L(q)/q is by how much a uniform pressure compresses it",
            )
        return
    found = long / wave
    if not abs(found - compression) <= _LONG * max(abs(compression), 1e-3 * _height(values)):
        raise SceneError.of("substrate.compression", compression, f"the limit of L(q)/q for long waves, about {found:.6g} m")


def _require_fast(values: np.ndarray[Any, np.dtype[np.float64]]) -> None:
    """L comes to 1 as an exponential does, not as a power of q."""
    off = np.abs(values - 1)
    seen = np.flatnonzero(off > _SEEN)
    k = int(seen[-1]) if len(seen) else 0
    if k == 0 or off[-1] >= 0.9 * off[k // 2]:  # another limit is another fault
        return
    with np.errstate(divide="ignore"):
        power = float(np.log(off[k] / off[k - 1]) / np.log(WAVES[k] / WAVES[k - 1])) if off[k - 1] > 0 else -np.inf
    if power > _SLOWEST:
        raise SceneError.of(
            "substrate.symbol(q)", float(values[k]), f"1 for short waves as by exp(-q h), and not as q^{power:.2g}, as about q = "
            f"{WAVES[k]:.3g} 1/m: a modulus that varies from the very surface on has no smooth kernel; give it a uniform surface layer",
        )


def _compression(substrate: Substrate) -> float | None:
    given: Any = substrate.compression
    if given is None:
        return None
    if isinstance(given, bool) or not isinstance(given, Real) or not isfinite(given) or given < 0:
        raise SceneError.of("substrate.compression", given, "None, or a length of at least 0 [m] (a property, not a method)")
    return float(given)


def _height(values: np.ndarray[Any, np.dtype[np.float64]]) -> float:
    """About the height of the body [m]: the inverse of the wave at which L goes over to 1."""
    return float(1 / WAVES[np.argmax(values > 0.5)])
