"""Points of a grid that are solved together: along the control of one scene they share work, as
those of `contact.solve_many` do.

In another process, or on another machine, a scene arrives as bytes.
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

# Numbers by name, `failed`, `reason` and `warning`; of chunks as a whole, `solution`, or `raised`.
Row = dict[str, Any]
Rows = list[tuple[int, Row]]

# For each that solves there are so many chunks: the last ones end about together.
_EACH = 4
# A curve of fewer points is hardly one: the first of each costs a search.
_SHORTEST = 6
# So much is lost where a process ends, or the sweep is broken off [s].
_SECONDS = 20.0
# Where solutions themselves are handed in: what follows has a search to make again.
_SECONDS_WHOLE = 60.0


@dataclass(frozen=True)
class Chunk:
    """Places in the grid, in the order in which they are solved, and what is set at each;
    `control`: what goes along them, if any does; `seconds`: after which what is solved is handed
    in; `whole`: whether that is the solutions themselves.
    """

    places: tuple[int, ...]
    settings: tuple[dict[str, Value], ...]
    control: str
    seconds: float
    whole: bool = False

    @classmethod
    def of_curve(cls, control: str, places: Sequence[int], values: Array) -> "Chunk":
        """Solutions themselves, at some of the values of a control."""
        settings: list[dict[str, Value]] = [
            {BRANCH: BRANCHES[0], f"control.{control}": float(values[place])} for place in places
        ]
        return cls(tuple(places), tuple(settings), control, _SECONDS_WHOLE, whole=True)

    def singly(self) -> "Iterator[Chunk]":
        """Its points, each a chunk."""
        for place, setting in zip(self.places, self.settings, strict=True):
            yield replace(self, places=(place,), settings=(setting,))

    def without(self, rows: Rows) -> "list[Chunk]":
        """What is left when its first rows are there: one chunk, or none."""
        done = len(rows)
        return (
            [replace(self, places=self.places[done:], settings=self.settings[done:])]
            if done < len(self.places)
            else []
        )


def chunks_of(
    axes: Sequence[Axis], wanted: Mask, solvers: int | None, branch: str = BRANCHES[0]
) -> list[Chunk]:
    """What is wanted of the grid (flat), cut for so many solvers; None: each curve is one chunk.
    branch: where it is not varied.
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
        else max(_SHORTEST, ceil(int(wanted.sum()) / (_EACH * solvers)))
    )
    points = itertools.product(*(axis.values for axis in axes))
    settings: list[dict[str, Value]] = [
        {BRANCH: branch, **dict(zip((axis.key for axis in axes), point, strict=True))}
        for point in points
    ]
    found = []
    for line in lines:
        places = [int(place) for place in line if wanted[place]]
        # As even as can be.
        for part in np.array_split(places, ceil(len(places) / most)) if places else ():
            found.append(
                Chunk(
                    tuple(int(p) for p in part), tuple(settings[p] for p in part), control, _SECONDS
                )
            )
    return found


def solve_chunk(scene: Scene, chunk: Chunk, tol: float) -> Rows:
    """Its rows, the first and as many as its seconds allow from there; whatever goes wrong at a
    point is that point's.
    """
    coming = solved(scene, chunk, tol)
    rows = [next(coming)]
    end = time.monotonic() + chunk.seconds
    while time.monotonic() <= end and (row := next(coming, None)) is not None:
        rows.append(row)
    return rows


def solved(scene: Scene, chunk: Chunk, tol: float) -> Iterator[tuple[int, Row]]:
    """The same, one after another."""
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
            # Errors of the package, and those of a user's own profile: the other points are none
            # the worse for it.
            row = (
                {"raised": error}
                if chunk.whole
                else failure(f"{type(error).__name__}: {' '.join(str(error).split())}")
            )
        yield place, row


def _curve(scene: Scene, chunk: Chunk, tol: float) -> Curve | None:
    """The curve that the points are on, with what can be solved of them at once; None without a
    control, off the branch that curves are of, or without any scene.
    """
    if not chunk.control or any(setting[BRANCH] != BRANCHES[0] for setting in chunk.settings):
        return None
    known: list[Scene] = []
    for setting in chunk.settings:
        # What is wrong with a point is told where that one is solved.
        with suppress(Exception):
            known.append(varied(scene, setting))
    if not known:
        return None
    curve = Curve(known[0], chunk.control, tol)
    with suppress(Exception), unwarned():
        curve.look_at(np.array([here.control[1] for here in known]))
    return curve


def failure(reason: str) -> Row:
    """The row of a point without a solution."""
    return {**dict.fromkeys(NUMBERS, nan), "failed": True, "reason": reason, "warning": ""}


def _row(solution: Solution) -> Row:
    return {
        **numbers(solution),
        "failed": False,
        "reason": "",
        "warning": "; ".join(solution.warnings),
    }


def solve_sent(given: bytes, chunk: Chunk, tol: float) -> Rows:
    """The rows of a chunk of a scene that was sent."""
    return solve_chunk(_received(given), chunk, tol)


def cannot_receive(given: bytes, here: str) -> str:
    """Why it is of no use where it arrives, as the end of a sentence; empty where it is. here: the
    version of this package that sent it.
    """
    if version() != here:
        return f"have sie-contact {version()}, and not {here}"
    try:
        _received(given)
    except Exception as error:
        return f"cannot make the scene ({type(error).__name__}: {error}): what it is made of belongs in a module that they can import"
    return ""


class Question:
    """Asks `cannot_receive` where it is unpickled, for places of which it is not known whether they
    have this package at all.
    """

    def __init__(self, given: bytes) -> None:
        self.given = given

    def __reduce__(self) -> tuple[Any, ...]:
        return cannot_receive, (self.given, version())


@lru_cache(maxsize=1)
def _received(given: bytes) -> Scene:
    return pickle.loads(given)
