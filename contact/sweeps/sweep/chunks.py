"""Chunks: points of a grid of scenes that are solved together in one process.

Points that differ only in the value of a control share work, as in `contact.solve_many`. Another
process or machine receives the scene as bytes.
"""

import itertools
import pickle
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from math import ceil, nan
from typing import Any

import numpy as np

from contact.errors import unwarned
from contact.extras import version
from contact.model.scene import Scene
from contact.solution.solution import Solution
from contact.solver import solve
from contact.sweeps.curve import Curve
from contact.sweeps.points import NUMBERS, numbers
from contact.sweeps.sweep.keys import BRANCH, BRANCHES, Axis, Value, varied
from sie import Array, Mask

# A row is the result of one point. It holds numbers by name, and the entries `failed`, `reason` and
# `warning`. In a chunk of whole solutions, it holds the `solution` or the exception `raised`.
Row = dict[str, Any]
Rows = list[tuple[int, Row]]


@dataclass(frozen=True)
class ChunkOptions:
    """Sizes of chunks; the time of a sweep depends on these sizes only weakly."""

    # Number of chunks for each process. It is above 1, so that all processes finish at about the
    # same time.
    per_process: int = 4
    # A process returns the finished rows of its chunk after this time [s]. If the process dies, at
    # most the work of this time is lost.
    seconds: float = 20.0


CHUNKS = ChunkOptions()


@dataclass(frozen=True)
class Chunk:
    """Points of a grid, in the order in which they are solved.

    places: flat indices of the points in the grid; settings: the values of the varied keys at each
    point; control: the control that varies from point to point, or ""; seconds: the time after
    which finished rows are sent; whole: whether rows hold the solutions themselves.
    """

    places: tuple[int, ...]
    settings: tuple[dict[str, Value], ...]
    control: str
    seconds: float
    whole: bool = False

    @classmethod
    def of_curve(cls, control: str, places: Sequence[int], values: Array) -> "Chunk":
        """A chunk of points along a curve: the scene at some of the values of a control.
        Its rows hold whole solutions.
        """
        settings: list[dict[str, Value]] = [
            {BRANCH: BRANCHES[0], f"control.{control}": float(values[place])} for place in places
        ]
        return cls(tuple(places), tuple(settings), control, CHUNKS.seconds, whole=True)

    def singly(self) -> "Iterator[Chunk]":
        """Yield one chunk for each point of this chunk."""
        for place, setting in zip(self.places, self.settings, strict=True):
            yield replace(self, places=(place,), settings=(setting,))

    def without(self, rows: Rows) -> "list[Chunk]":
        """A list of one chunk with the points that are not in `rows`; empty if there are none."""
        done = len(rows)
        return (
            [replace(self, places=self.places[done:], settings=self.settings[done:])]
            if done < len(self.places)
            else []
        )


def chunks_of(
    axes: Sequence[Axis], wanted: Mask, solvers: int | None, branch: str = BRANCHES[0]
) -> list[Chunk]:
    """The points of the grid to be solved, divided into chunks for a number of processes.

    wanted: flat mask of these points; solvers: number of processes, None: one chunk for each curve
    of points along the control; branch: the branch of equilibria, unless an axis varies it.
    """
    at = next((place for place, axis in enumerate(axes) if axis.control), None)
    control = "" if at is None else axes[at].control
    shape = [len(axis.values) for axis in axes]
    indices = np.arange(wanted.size).reshape(shape)
    if at is None:
        lines = indices.reshape(-1, 1)
    else:
        upwards = np.argsort(np.array(axes[at].values, dtype=float), kind="stable")
        lines = np.moveaxis(indices, at, -1)[..., upwards].reshape(-1, shape[at])
    most = (
        wanted.size
        if solvers is None
        else max(1, ceil(int(wanted.sum()) / (CHUNKS.per_process * solvers)))
    )
    points = itertools.product(*(axis.values for axis in axes))
    settings: list[dict[str, Value]] = [
        {BRANCH: branch, **dict(zip((axis.key for axis in axes), point, strict=True))}
        for point in points
    ]
    found = []
    for line in lines:
        places = [int(place) for place in line if wanted[place]]
        for part in np.array_split(places, ceil(len(places) / most)) if places else ():
            values = tuple(settings[p] for p in part)
            found.append(Chunk(tuple(int(p) for p in part), values, control, CHUNKS.seconds))
    return found


def solve_chunk(scene: Scene, chunk: Chunk, tol: float) -> Rows:
    """Solve a chunk and return its finished rows: at least one, and more until the time is over.

    An error at one point becomes the row of that point.
    """
    coming = solved(scene, chunk, tol)
    rows = [next(coming)]
    end = time.monotonic() + chunk.seconds
    while time.monotonic() <= end and (row := next(coming, None)) is not None:
        rows.append(row)
    return rows


def solved(scene: Scene, chunk: Chunk, tol: float) -> Iterator[tuple[int, Row]]:
    """Solve the points of a chunk one after another; yields the index and the row of each."""
    curve = _curve(scene, chunk, tol)
    for place, setting in zip(chunk.places, chunk.settings, strict=True):
        try:
            with unwarned():
                here = varied(scene, setting)
                solution = (
                    solve(here, tol, branch=str(setting[BRANCH]))
                    if curve is None
                    else curve.at(here.control[1])
                )
                row = {"solution": solution} if chunk.whole else _row(solution)
        except Exception as error:
            # Any error makes only this point fail, even an error in a user's own profile.
            row = (
                {"raised": error}
                if chunk.whole
                else failure(f"{type(error).__name__}: {' '.join(str(error).split())}")
            )
        yield place, row


def _curve(scene: Scene, chunk: Chunk, tol: float) -> Curve | None:
    """The `Curve` that solves the points of a chunk in turn; None if each point is solved alone.

    It is None if no control varies, if the branch is not the default one, or if no point is a valid
    scene. Points with a closed form are solved when the `Curve` is made.
    """
    if not chunk.control or any(setting[BRANCH] != BRANCHES[0] for setting in chunk.settings):
        return None
    known: list[Scene] = []
    for setting in chunk.settings:
        # An invalid point is left out here. Its error is reported when the point itself is solved.
        with suppress(Exception):
            known.append(varied(scene, setting))
    if not known:
        return None
    curve = Curve(known[0], chunk.control, tol)
    with suppress(Exception), unwarned():
        curve.solve_in_closed_form(np.array([here.control[1] for here in known]))
    return curve


def failure(reason: str) -> Row:
    """The row of the results for a point at which no solution was found."""
    return {**dict.fromkeys(NUMBERS, nan), "failed": True, "reason": reason, "warning": ""}


def _row(solution: Solution) -> Row:
    return {
        **numbers(solution),
        "failed": False,
        "reason": "",
        "warning": "; ".join(solution.warnings),
    }


def solve_sent(given: bytes, chunk: Chunk, tol: float) -> Rows:
    """Solve a chunk for a scene received as bytes; returns the rows."""
    return solve_chunk(_received(given), chunk, tol)


def cannot_receive(given: bytes, here: str) -> str:
    """Reason why this process cannot use a received scene; "" if the process can use it.

    The reason is the end of a sentence. here: version of `contact` in the sending process.
    """
    if version() != here:
        return f"have sie-contact {version()} instead of {here}"
    try:
        _received(given)
    except Exception as error:
        return (
            f"cannot rebuild the scene ({type(error).__name__}: {error}): "
            "define its classes and functions in a module that they can import"
        )
    return ""


class Question:
    """An object that becomes the result of `cannot_receive` when it is unpickled.

    On a machine without the package `contact`, unpickling raises an ImportError instead.
    """

    def __init__(self, given: bytes) -> None:
        self.given = given

    def __reduce__(self) -> tuple[Any, ...]:
        return cannot_receive, (self.given, version())


@lru_cache(maxsize=1)
def _received(given: bytes) -> Scene:
    return pickle.loads(given)
