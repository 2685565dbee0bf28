"""Chunks solved by the workers of a Dask scheduler (the extra `cluster`).

A worker that is lost on the way loses nothing: the scheduler gives what it ran to another. Workers may come and go at any time.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

from contact.errors import ContactError, SceneError
from contact.extras import require
from contact.model.scene import Scene
from contact.sweeps.sweep.chunks import Chunk, Rows, failure, solve_chunk

_PATIENCE = "10s"


class Cluster:
    """A scheduler, by its address or as a dask.distributed.Client, which stays the caller's."""

    def __init__(self, scheduler: Any) -> None:
        self._distributed = require("distributed")
        self._own = isinstance(scheduler, str)
        if not self._own and not isinstance(scheduler, self._distributed.Client):
            raise SceneError.of("scheduler", scheduler, "None, the address of a Dask scheduler, or a dask.distributed.Client")
        try:
            self._client = self._distributed.Client(scheduler, timeout=_PATIENCE, set_as_default=False) if self._own else scheduler
        except (OSError, ValueError, TypeError) as error:
            why = " ".join(str(error).split()) or type(error).__name__
            allowed = f"the address of a Dask scheduler that answers, such as tcp://host:8786 ({why})"
            raise SceneError.of("scheduler", scheduler, allowed) from error

    @property
    def solvers(self) -> int:
        """Threads of the workers that are there now."""
        return sum(self._client.ncores().values())

    def solved(self, scene: Scene, chunks: Sequence[Chunk], tol: float) -> Generator[Rows]:
        """Rows of chunks as these are done, in any order."""
        client = self._client
        # A task of its own: sent once, and made again where the worker that keeps it is lost.
        given = client.submit(_same, scene, pure=False)
        running = {client.submit(solve_chunk, given, chunk, tol, pure=False): chunk for chunk in chunks}
        try:
            for future in self._distributed.as_completed(list(running), loop=client.loop):
                chunk = running.pop(future)
                yield self._rows(future, chunk)
        finally:
            client.cancel(list(running))

    def _rows(self, future: Any, chunk: Chunk) -> Rows:
        error = None if future.status == "finished" else future.exception() if future.status == "error" else future.status
        if error is None:
            rows: Rows = future.result()
            return rows
        if isinstance(error, self._distributed.KilledWorker):
            return [(place, failure("every worker that solved it ended, killed or out of memory")) for place in chunk.places]
        if isinstance(error, str):
            raise ContactError(f"the scheduler is gone, or has given up: points are {error}")
        raise ContactError(f"the workers of the scheduler cannot solve: {type(error).__name__}: {error}")

    def close(self) -> None:
        if self._own:
            self._client.close()


def _same(scene: Scene) -> Scene:
    return scene
