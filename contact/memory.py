"""Memory that large arrays leave, kept for the next ones while a large scene is solved.

glibc asks the system for every array above 32 MB and gives it back at once. The system clears it
again, page by page, as it is first written to, which takes longer than most of what is done with
such an array. While a large scene is solved it stays with the process.
"""

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from contact.users import WhileUsed

# Of <malloc.h>: what is given back at the end of the heap, at the least, and how many arrays are
# asked for on their own, at the most.
_TRIM_THRESHOLD = -1
_MMAP_MAX = -4
# As they come to be in a process of large arrays: twice the largest array of the heap, and as many
# as glibc allows.
_USUAL = {_TRIM_THRESHOLD: 1 << 26, _MMAP_MAX: 1 << 16}
_KEPT = {_TRIM_THRESHOLD: -1, _MMAP_MAX: 0}


@contextmanager
def kept(wanted: bool = True) -> Iterator[None]:
    """While it lasts, and if it is wanted, what arrays leave is kept. With another library than
    glibc nothing changes.
    """
    if not wanted or _libc() is None:
        yield
        return
    with _keeping():
        yield


def _keep() -> Any:
    libc = _libc()
    _set(libc, _KEPT)
    return libc


def _give_back(libc: Any) -> None:
    _set(libc, _USUAL)
    libc.malloc_trim(0)


def _set(libc: Any, options: dict[int, int]) -> None:
    for name, value in options.items():
        libc.mallopt(name, value)


_keeping = WhileUsed(_keep, _give_back)


def _libc() -> ctypes.CDLL | None:
    """The C library, if it is glibc."""
    try:
        libc = ctypes.CDLL(None)
        libc.gnu_get_libc_version  # noqa: B018
    except (OSError, TypeError, AttributeError):
        return None
    return libc
