"""Compiled loops (`sie.loops`) for large sums: when they are loaded, how they use threads.

numba stores the compiled code in a folder: beside the package, in the user's cache, or in
`NUMBA_CACHE_DIR`. The loops release Python's global lock. They run in ordinary threads that end
with the sum, so that processes may fork at any time.
"""

import os
from collections.abc import Callable, Sequence
from contextvars import copy_context
from functools import cache, partial
from threading import Thread
from types import ModuleType
from typing import Any

import numpy as np

from sie.basis import lazy
from sie.basis.data import Index

# Compiled loops are loaded if all sums of a solution together have at least this many terms.
# Loading numba and a stored loop takes 0.3 s. In this time numpy adds about as many terms.
# Insensitive to a factor of four.
MIN_TERMS = 1 << 28
# Assumed number of times that a solution computes the same sum: a few dozen steps of GMRES in each
# of a few steps of Newton's method.
REPETITIONS = 128
# A sum that is computed only once counts as this many sums. For it, numpy also computes the data of
# its terms, such as the arguments of their series, which takes some 10 ns a term.
ONCE = 8
# Least number of terms for each thread. Adding so many terms takes some 0.3 ms, and starting a
# thread takes 0.05 ms.
TERMS_PER_THREAD = 1 << 20


def loops(name: str, terms: float, repeated: bool = True) -> ModuleType | None:
    """The compiled module `name` of `sie.loops`; None for a short sum or if numba does not work.

    terms: number of terms of the sum. repeated: whether a solution computes the sum many times.
    """
    enough = terms * (REPETITIONS if repeated else ONCE) >= MIN_TERMS
    return _loaded(name) if enough else None


@cache
def _loaded(name: str) -> ModuleType | None:
    try:
        return lazy.module(f"sie.loops.{name}")
    except (ImportError, RuntimeError):  # no numba, or no folder in which it could store its code
        return None


def threads() -> int:
    """Number of threads: one for each usable processor, but at most `OMP_NUM_THREADS`."""
    usable = (
        len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    )
    asked = os.environ.get("OMP_NUM_THREADS", "")
    return max(1, min(usable, int(asked))) if asked.isdecimal() else usable


def in_threads(loop: Callable[..., None], starts: Index, *arguments: Any) -> None:
    """Run loop(begin, end, *arguments) in several threads, each on its own range of the items.
    The items are sums of different lengths.

    Parameters
    ----------
    loop : callable
        Writes to its own items only. It must release Python's global lock most of the time.
    starts : ndarray
        Number of terms before each of the n items, followed by the number of all terms (n + 1,).
        The ranges have about the same number of terms, and at least 2^20. A term takes some 0.3 ns.
    arguments
        Further arguments of `loop`.

    Returns
    -------
    None

    Examples
    --------
    >>> import numpy as np, sie
    >>> squares = np.zeros(4)
    >>> def loop(begin, end):
    ...     squares[begin:end] = np.arange(begin, end) ** 2
    >>> sie.in_threads(loop, np.arange(5) * 2**20)
    >>> squares.tolist()
    [0.0, 1.0, 4.0, 9.0]
    """
    count = max(1, min(threads(), int(starts[-1]) // TERMS_PER_THREAD))
    inner = np.searchsorted(starts, np.linspace(0, starts[-1], count + 1)[1:-1])
    cuts = [0, *inner.tolist(), len(starts) - 1]
    parts = [(begin, end) for begin, end in zip(cuts[:-1], cuts[1:], strict=True) if begin < end]
    together([partial(loop, *part, *arguments) for part in parts])


def together(calls: Sequence[Callable[[], Any]]) -> list[Any]:
    """The results of calls that run at the same time, each in a thread of its own.

    numpy's settings of warnings hold in all threads. An error in a thread is raised here.
    """
    results, errors = [None] * len(calls), []

    def run(number: int) -> None:
        try:
            results[number] = calls[number]()
        except BaseException as error:
            errors.append(error)

    others = [
        Thread(target=copy_context().run, args=(run, number)) for number in range(1, len(calls))
    ]
    for thread in others:
        thread.start()
    try:
        if len(calls):
            results[0] = calls[0]()
    finally:
        for thread in others:
            thread.join()
    if errors:
        raise errors[0]
    return results
