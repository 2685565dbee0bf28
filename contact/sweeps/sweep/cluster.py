"""Chunks solved by the workers of a Dask scheduler (the extra `cluster`).

A worker that is lost on the way loses nothing: the scheduler gives what it ran to another. Workers may come and go at any time.
"""

import pickle
from collections.abc import Generator, Sequence
from typing import Any

from contact.errors import ContactError, SceneError
from contact.extras import require
from contact.model.scene import Scene
from contact.search.topology.loop import Progress
from contact.sweeps.sweep.chunks import Chunk, Question, Rows, failure, solve_sent

_PATIENCE = "10s"
# Work is cut for so many at the least.
_EXPECTED = 16


class Cluster:
    """A scheduler, by its address or as a dask.distributed.Client, which stays the caller's."""

    def __init__(self, scheduler: Any, progress: Progress | None) -> None:
        self._distributed = require("distributed")
        self._own = isinstance(scheduler, str)
        if not self._own and not isinstance(scheduler, self._distributed.Client):
            raise SceneError.of("scheduler", scheduler, "None, the address of a Dask scheduler, or a dask.distributed.Client")
        try:
            self._client = self._distributed.Client(scheduler, timeout=_PATIENCE, set_as_default=False) if self._own else scheduler
        except Exception as error:  # whatever a connection fails of
            why = " ".join(str(error).split()) or type(error).__name__
            allowed = f"the address of a Dask scheduler that answers, such as tcp://host:8786 ({why})"
            raise SceneError.of("scheduler", scheduler, allowed) from error
        if not self._client.ncores():
            if progress is not None:
                progress("waiting for a worker", 0, None)
            self._client.wait_for_workers(1)

    @property
    def solvers(self) -> int:
        """Threads of the workers that are there now, and some for those to come."""
        return max(_EXPECTED, sum(self._client.ncores().values()))

    def solved(self, scene: Scene, chunks: Sequence[Chunk], tol: float) -> Generator[Rows]:
        """Rows of chunks as these are done, in any order."""
        client = self._client
        # By value what no module holds, as the classes of a script.
        scene_sent = require("cloudpickle").dumps(scene)
        self._ask(scene_sent)
        # A task of its own: sent once, and made again where the worker that keeps it is lost.
        given = client.submit(_same, scene_sent, pure=False)
        running = {client.submit(solve_sent, given, chunk, tol, pure=False): chunk for chunk in chunks}
        try:
            # Fetched as they are done: a worker that is lost later takes no results with it.
            done = self._distributed.as_completed(list(running), loop=client.loop, with_results=True, raise_errors=False)
            for future, found in done:
                chunk = running.pop(future)
                rows = self._checked(future, found, chunk)
                for rest in chunk.without(rows):
                    again = client.submit(solve_sent, given, rest, tol, pure=False)
                    running[again] = rest
                    done.add(again)
                yield rows
        finally:
            client.cancel(list(running))

    def _ask(self, given: bytes) -> None:
        """Whether the workers have what the scene needs: one that cannot import it would end, and the sweep wait for others."""
        answers = self._client.run(pickle.loads, pickle.dumps(Question(given)), on_error="return")
        for worker, answer in answers.items():
            if answer:
                why = f"cannot import contact ({answer})" if isinstance(answer, BaseException) else answer
                raise ContactError(f"the workers of the scheduler {why} (asked: {worker})")

    def _checked(self, future: Any, rows: Rows, chunk: Chunk) -> Rows:
        """The rows, or those of points that cannot be solved; an error where the cluster is at fault."""
        if future.status == "finished":
            return rows
        if future.status != "error":
            raise ContactError(f"the scheduler is gone, or has given up: points are {future.status}")
        error = future.exception()
        if isinstance(error, self._distributed.KilledWorker):
            return [(place, failure("every worker that solved it ended, killed or out of memory")) for place in chunk.places]
        raise ContactError(f"the workers of the scheduler cannot solve: {type(error).__name__}: {error}")

    def close(self) -> None:
        if self._own:
            self._client.close()


def _same(given: bytes) -> bytes:
    return given
