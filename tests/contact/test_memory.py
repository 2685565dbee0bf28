"""Freed memory is kept by the process inside `keep_freed_memory`, and given back afterwards."""

import ctypes

import pytest

from contact import runtime


class Told:
    """Stands in for the C library, and records the calls."""

    def __init__(self):
        self.calls = []

    def mallopt(self, name, value):
        self.calls.append((name, value))

    def malloc_trim(self, pad):
        self.calls.append("given back")


def test_memory_is_kept_from_the_first_block_that_asks_for_it_to_the_end_of_the_last(monkeypatch):
    libc = Told()
    monkeypatch.setattr(runtime, "_libc", lambda: libc)
    with runtime.keep_freed_memory():
        assert libc.calls == [(-1, -1), (-4, 0)]
        with runtime.keep_freed_memory(), pytest.raises(KeyError), runtime.keep_freed_memory():
            raise KeyError
        with runtime.keep_freed_memory(False):
            pass
        assert len(libc.calls) == 2
    assert libc.calls[2:] == [(-1, 1 << 26), (-4, 1 << 16), "given back"]


def test_without_glibc_nothing_is_changed(monkeypatch):
    def missing(_):
        raise OSError

    monkeypatch.setattr(ctypes, "CDLL", missing)
    with runtime.keep_freed_memory():
        pass
    assert runtime._freed_memory_is_kept.users == 0
