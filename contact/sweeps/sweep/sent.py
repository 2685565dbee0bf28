"""A scene in another process or on another machine: what arrives there, and what is solved there."""

import pickle
from functools import lru_cache
from typing import Any

from contact.extras import version
from contact.model.scene import Scene
from contact.sweeps.sweep.chunks import Chunk, Rows, solve_chunk


def solve_sent(given: bytes, chunk: Chunk, tol: float) -> Rows:
    """The rows of a chunk of a scene that was sent."""
    return solve_chunk(_received(given), chunk, tol)


def cannot_receive(given: bytes, here: str) -> str:
    """Why it is of no use where it arrives, as the end of a sentence; empty where it is. here: the version of this package that sent it."""
    if version() != here:
        return f"have sie-contact {version()}, and not {here}"
    try:
        _received(given)
    except Exception as error:
        return f"cannot make the scene ({type(error).__name__}: {error}): what it is made of belongs in a module that they can import"
    return ""


class Question:
    """Asks `cannot_receive` where it is unpickled, for places of which it is not known whether they have this package at all."""

    def __init__(self, given: bytes) -> None:
        self.given = given

    def __reduce__(self) -> tuple[Any, ...]:
        return cannot_receive, (self.given, version())


@lru_cache(maxsize=1)
def _received(given: bytes) -> Scene:
    scene: Scene = pickle.loads(given)
    return scene
