"""What holds for a whole process while any of its threads asks for it."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock
from typing import Any


class WhileUsed:
    """Begun by the first who uses it and ended by the last, in any thread; ended is called with
    what begun gave.
    """

    def __init__(self, begun: Callable[[], Any], ended: Callable[[Any], object]) -> None:
        self._begun, self._ended = begun, ended
        self._lock, self._before, self.users = Lock(), None, 0

    @contextmanager
    def __call__(self) -> Iterator[None]:
        with self._lock:
            if self.users == 0:
                self._before = self._begun()
            self.users += 1
        try:
            yield
        finally:
            with self._lock:
                self.users -= 1
                if self.users == 0:
                    self._ended(self._before)
