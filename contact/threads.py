"""One thread for the many small matrices of adhesive equilibria.

Of matrices of some hundred rows the threads of BLAS wait for one another longer than they work: a way of 87 zones down to where they come
apart takes twice as long with two threads as with one, and four times the processor time.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock
from typing import Any

from contact.extras import require

_lock = Lock()
# Who asked for one thread and has not done yet, and what gives back what there was before the first of them.
_users: list[object] = []
_limits: list[Any] = []


@contextmanager
def one_of_blas() -> Iterator[None]:
    """While it lasts in any thread of this process, BLAS has one of its own; as many as before thereafter."""
    user = object()
    with _lock:
        if not _users:
            _limits.append(require("threadpoolctl").threadpool_limits(1, "blas"))
        _users.append(user)
    try:
        yield
    finally:
        with _lock:
            _users.remove(user)
            if not _users:
                _limits.pop().restore_original_limits()
