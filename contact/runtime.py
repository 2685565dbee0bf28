"""Settings of the whole process: memory kept by malloc, and the number of BLAS threads.

A setting is changed while at least one thread asks for the change. The setting is restored when the
last of these threads has finished.
"""

import ctypes
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import IntEnum
from functools import cache
from threading import Lock
from typing import Any

from contact.extras import require


class _Mallopt(IntEnum):
    """Parameters of the C function mallopt, numbered as in <malloc.h>."""

    # The trim threshold is the number of free bytes that the top of the heap may keep. More free
    # bytes are returned to the system.
    TRIM_THRESHOLD = -1
    MMAP_MAX = -4  # bounds the number of blocks that are mapped one by one


# These values of glibc's settings are restored when freed memory need no longer be kept. The trim
# threshold is the value that glibc itself reaches in a process with large arrays. MMAP_MAX has
# glibc's default.
_GLIBC_DEFAULTS = {_Mallopt.TRIM_THRESHOLD: 1 << 26, _Mallopt.MMAP_MAX: 1 << 16}
_KEEP_ALL = {_Mallopt.TRIM_THRESHOLD: -1, _Mallopt.MMAP_MAX: 0}


class SharedState:
    """A setting of the whole process that concurrent `with` blocks of all threads share.

    The first block to begin calls `enter`. The last block to end calls `leave` with the result of
    `enter`.
    """

    def __init__(self, enter: Callable[[], Any], leave: Callable[[Any], object]) -> None:
        self._enter, self._leave = enter, leave
        self._lock, self._before, self.users = Lock(), None, 0

    @contextmanager
    def __call__(self) -> Iterator[None]:
        with self._lock:
            if self.users == 0:
                self._before = self._enter()
            self.users += 1
        try:
            yield
        finally:
            with self._lock:
                self.users -= 1
                if self.users == 0:
                    self._leave(self._before)


@contextmanager
def keep_freed_memory(wanted: bool = True) -> Iterator[None]:
    """If `wanted`, let the process keep the memory of freed arrays while the block runs.

    By default glibc maps new memory for every array above 32 MB, and unmaps this memory when the
    array is freed. The system clears the pages of each new array at first use, which takes longer
    than most operations on such an array. With other C libraries nothing is changed.
    """
    if not wanted or _libc() is None:
        yield
        return
    with _freed_memory_is_kept():
        yield


def _start_keeping() -> Any:
    libc = _libc()
    _set(libc, _KEEP_ALL)
    return libc


def _stop_keeping(libc: Any) -> None:
    _set(libc, _GLIBC_DEFAULTS)
    libc.malloc_trim(0)


def _set(libc: Any, parameters: dict[_Mallopt, int]) -> None:
    for name, value in parameters.items():
        libc.mallopt(int(name), value)


_freed_memory_is_kept = SharedState(_start_keeping, _stop_keeping)


def _libc() -> ctypes.CDLL | None:
    """The C library of the process if it is glibc; None on other systems."""
    try:
        libc = ctypes.CDLL(None)
        libc.gnu_get_libc_version  # noqa: B018
    except (OSError, TypeError, AttributeError):
        return None
    return libc


@cache
def _blas_libraries(scipy_is_loaded: bool) -> Any:
    return require("threadpoolctl").ThreadpoolController()


def _limit_to_one_thread() -> Any:
    # numpy and scipy may each bring their own BLAS. Finding these libraries takes milliseconds, so
    # the result of `_blas_libraries` is cached.
    return _blas_libraries("scipy.linalg" in sys.modules).limit(limits=1, user_api="blas")


# Context in which BLAS runs on one thread. For matrices of some hundred rows, the threads of BLAS
# wait for each other as long as they compute. On a quiet machine, a rough trace of 200 zones takes
# the same time with one thread and with two. On a busy machine, one thread takes a third of the
# time of two.
one_blas_thread = SharedState(_limit_to_one_thread, lambda limits: limits.restore_original_limits())
