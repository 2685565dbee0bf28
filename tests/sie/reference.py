"""Transforms and potentials by adaptive quadrature in theta, where x = middle + w cos(theta).
They use neither the solver nor closed forms.

The principal value at theta = alpha is QUADPACK's (`weight="cauchy"`), on a short piece around
alpha.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import quad


def cauchy(d):
    return 1 / d


def hilbert(period):
    return lambda d: math.pi / period / math.tan(math.pi * d / period)


def log_cauchy(d):
    return math.log(abs(d))


def log_hilbert(period):
    return lambda d: math.log(abs(2 * math.sin(math.pi * d / period)))


def _pieces(breaks):
    breaks = sorted({0.0, math.pi, *breaks})
    return zip(breaks[:-1], breaks[1:], strict=True)


def _integral(f, breaks):
    return sum(
        quad(f, lo, hi, limit=200, epsabs=1e-13, epsrel=1e-12)[0] for lo, hi in _pieces(breaks)
    )


def _angle(x, a, b):
    return 2 * math.atan2(math.sqrt(b - x), math.sqrt(x - a))


def _singular(kinks, a, b):
    return [_angle(s, a, b) for s in kinks if a < s < b]


def transform(at, zones, x, kernel, kinks=()):
    """Returns (1/pi) PV int phi(xi) K(x - xi) dxi.

    at(t, zone) is the density at the scaled position t of a zone; kinks are its singular points.
    """
    total = 0.0
    for i, (a, b) in enumerate(zones):
        w, middle, special = 0.5 * (b - a), 0.5 * (a + b), _singular(kinks, a, b)

        def integrand(theta, i=i, w=w, middle=middle):
            xi = middle + w * math.cos(theta)
            return float(at(np.cos(theta), i)) * w * math.sin(theta) * kernel(x - xi) / math.pi

        if not a < x < b:
            total += _integral(integrand, special)
            continue
        alpha = _angle(x, a, b)
        room = 0.5 * min(abs(alpha - s) for s in (0.0, math.pi, *special))
        low, high = alpha - 0.9 * room, alpha + room
        value = quad(
            lambda theta, f=integrand, alpha=alpha: f(theta) * (theta - alpha),
            low,
            high,
            weight="cauchy",
            wvar=alpha,
            limit=200,
            epsabs=1e-13,
            epsrel=1e-12,
        )[0]
        for lo, hi in _pieces([low, high, *special]):
            if not (lo >= low and hi <= high):
                value += quad(integrand, lo, hi, limit=200, epsabs=1e-13, epsrel=1e-12)[0]
        total += value
    return total


def potential(at, zones, x, logarithm, kinks=()):
    """Returns (1/pi) int phi(xi) Lambda(x - xi) dxi, where Lambda is the function `logarithm`."""
    total = 0.0
    for i, (a, b) in enumerate(zones):
        w, middle, special = 0.5 * (b - a), 0.5 * (a + b), _singular(kinks, a, b)
        if a < x < b:
            special.append(_angle(x, a, b))

        def integrand(theta, i=i, w=w, middle=middle):
            xi = middle + w * math.cos(theta)
            return float(at(np.cos(theta), i)) * w * math.sin(theta) * logarithm(x - xi) / math.pi

        total += _integral(integrand, special)
    return total


def integral(at, zones, kinks=(), weight=lambda x: 1.0):
    """Returns the integral of weight(x) phi(x) over all zones."""
    total = 0.0
    for i, (a, b) in enumerate(zones):
        w, middle = 0.5 * (b - a), 0.5 * (a + b)

        def integrand(theta, i=i, w=w, middle=middle):
            return (
                float(at(np.cos(theta), i))
                * w
                * math.sin(theta)
                * weight(middle + w * math.cos(theta))
            )

        total += _integral(integrand, _singular(kinks, a, b))
    return total
