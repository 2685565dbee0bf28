"""Problems that together use every route through the engine. Each is a function of the size of
its data; it returns an equation, zones and keyword arguments of `sie.solve`.
"""

from __future__ import annotations

from functools import partial

import numpy as np

import sie

SINGULAR, FREE = sie.SINGULAR, sie.FREE


def wave(a: float, x: np.ndarray) -> np.ndarray:
    return a * np.sin(3 * x)


def rise(a: float, x: np.ndarray) -> np.ndarray:
    return -a * np.cos(3 * x) / 3


def _matrix(a, free, gap, symmetric=False):
    kind = FREE if free else SINGULAR
    level = (sie.Total(a), sie.EqualPotential())
    table = [[-1.0, -0.5 * gap], [0.5 * gap, 1.0]]
    value = (
        sie.Forcing(lambda x: a * x, lambda x: 0.5 * a * x * x)
        if free
        else sie.Forcing(partial(wave, a), partial(rise, a))
    )
    return (
        sie.Equation(sie.cauchy(), value, level),
        sie.Zones.of(table, kind, SINGULAR if symmetric and not free else kind, symmetric),
        {},
    )


def _free(a):
    return (
        sie.Equation(sie.cauchy(), lambda x: a * x, sie.Total(a)),
        sie.Zones.of([[-1.0, 2.0]]),
        {},
    )


def _two_free(a):
    value = sie.Forcing(lambda x: a * (4 * x**3 - 2 * x), lambda x: a * (x**4 - x**2))
    return (
        sie.Equation(sie.cauchy(), value, (sie.Total(0.1 * a), sie.EqualPotential())),
        sie.Zones.of([[-1, -0.5], [0.5, 0.9]]),
        {},
    )


def _kink(a):
    return (
        sie.Equation(
            sie.cauchy(),
            sie.Forcing(lambda x: a * np.sign(x), jumps=sie.Jumps([0.0], 2 * a)),
            sie.Total(2 * a),
        ),
        sie.Zones.of([[-0.5, 2.0]]),
        {},
    )


def _adhesive(a):
    end = sie.free_with_intensity(-0.1 * a)
    return (
        sie.Equation(sie.cauchy(), lambda x: a * x, sie.Total(1.1 * a)),
        sie.Zones.of([[-0.9, 1.05]], end, end),
        {},
    )


def _width(a):
    equation = sie.Equation(
        sie.hilbert(1.0),
        lambda x: a * np.sin(2 * np.pi * x),
        sie.Total(None),
        (),
        sie.TotalWidth(0.4),
    )
    return equation, sie.Zones.of([[-0.3, 0.25]]), {"value": 0.1 * a}


def _column(a, of_column):
    conditions = (sie.Total(0.0), sie.moment(a))
    return (
        sie.Equation(sie.cauchy(), np.zeros_like, conditions, lambda x: of_column / (x * x + 2)),
        sie.Zones.of([[-1, 1]], SINGULAR, SINGULAR),
        {},
    )


def _smooth(a):
    kernel = sie.cauchy() + sie.Smooth(lambda x, xi: 0.3 * np.cos(x + 2 * xi))
    return (
        sie.Equation(kernel, partial(wave, a), sie.Total(a)),
        sie.Zones.of([[-1, 1]], SINGULAR, SINGULAR),
        {},
    )


def _many(a, count, free, kernel=None):
    kind = FREE if free else SINGULAR
    value = (lambda x: a * np.sin(2 * np.pi * x)) if free else partial(wave, a)
    half = 0.2 if free else 0.3
    table = [[i - half, i + half] for i in range(count)]
    total = 0.1 * a if free else a
    return (
        sie.Equation(kernel or sie.cauchy(), value, sie.ZoneTotals(total)),
        sie.Zones.of(table, kind, kind),
        {},
    )


def _of_lag(x, xi):
    return 0.3 * np.sin(0.1 * (x - xi))


ROUTES = {
    "matrix": partial(_matrix, free=False, gap=0.5),
    "mirrored": partial(_matrix, free=False, gap=0.5, symmetric=True),
    "slit": partial(_matrix, free=False, gap=5e-4),
    "free": _free,
    "two free": _two_free,
    "kink": _kink,
    "adhesive": _adhesive,
    "unknown total": _width,
    "column": partial(_column, of_column=1.0),
    "smooth kernel": _smooth,
    "some": partial(_many, count=30, free=False),
    "fast sums": partial(_many, count=150, free=False),
    "fast sums, free": partial(_many, count=150, free=True),
    "fast sums, smooth kernel": partial(
        _many, count=60, free=False, kernel=sie.cauchy() + sie.Smooth(_of_lag, of_lag=True)
    ),
}
