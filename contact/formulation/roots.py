"""A root in a bracket whose ends are known: a function that is costly, or starts from where it was last, is not asked there again."""

from __future__ import annotations

from collections.abc import Callable

from contact.extras import require


def bracketed(
    function: Callable[[float], float], known: dict[float, float], xtol: float, rtol: float = 4e-15, most: int = 100, strict: bool = False
) -> float:
    """The root by Brent's method (R. P. Brent, Algorithms for Minimization without Derivatives, 1973). known: the two ends and the values
    there, of opposite signs. strict: RuntimeError where the bracket does not close in `most` steps, else its last point."""
    root: float = require("scipy.optimize").brentq(
        lambda x: known[x] if x in known else function(x), *known, xtol=xtol, rtol=rtol, maxiter=most, disp=strict
    )
    return float(root)
