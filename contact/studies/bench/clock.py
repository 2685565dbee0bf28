"""Processor time and peak memory of a call."""

from __future__ import annotations

import gc
import signal
import threading
import time
import tracemalloc
from collections.abc import Callable
from types import FrameType
from typing import Any, TypeVar

T = TypeVar("T")


def seconds(call: Callable[[], Any], patience: float = 0.3, most: int = 25) -> float:
    """Least processor time [s] of a call over several repetitions.

    The call is repeated for `patience` s, but at most `most` times.

    The least time is taken because other work on the machine only adds to it.
    """
    best, spent, count = float("inf"), 0.0, 0
    collects = gc.isenabled()
    gc.disable()
    try:
        while count == 0 or (spent < patience and count < most):
            start = time.process_time()
            call()
            took = time.process_time() - start
            best, spent, count = min(best, took), spent + took, count + 1
    finally:
        if collects:
            gc.enable()
    return best


def short_seconds(call: Callable[[], Any], patience: float = 0.05) -> float:
    """Least processor time [s] of a call so short (microseconds) that it is timed in loops.

    The clock is read before and after many calls, as its resolution is too low for a single call.
    """
    call()
    start = time.process_time()
    count = 0
    while time.process_time() - start < 0.2 * patience:
        call()
        count += 1
    repeats = max(count, 1)

    def many() -> None:
        for _ in range(repeats):
            call()

    return seconds(many, 0.8 * patience) / repeats


def peak_bytes(call: Callable[[], Any]) -> int:
    """Peak memory [bytes] that Python and numpy allocated during a call."""
    gc.collect()
    tracemalloc.start()
    try:
        call()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


class TooLong(Exception):
    """Raised when a call takes more processor time than its limit."""


def limited(call: Callable[[], T], seconds: float) -> T:
    """Return the result of `call()`, or raise TooLong after `seconds` of processor time.

    There is no limit on systems without the signal SIGPROF, or outside the main thread. A call of
    numpy cannot be interrupted: the exception is raised when this call returns.
    """
    if not hasattr(signal, "SIGPROF") or threading.current_thread() is not threading.main_thread():
        return call()

    def ring(number: int, frame: FrameType | None) -> None:
        raise TooLong(f"given up after {seconds:g} s")

    before = signal.signal(signal.SIGPROF, ring)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        return call()
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)
