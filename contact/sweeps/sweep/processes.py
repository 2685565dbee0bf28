"""Chunks solved in this process, in other processes, or by the workers of a Dask scheduler.

If a process dies (killed, or out of memory), its chunk is solved again point by point; a point that
kills its process a second time is marked as failed. If other processes cannot be started, this
process solves everything.

If a worker of a scheduler is lost, the scheduler gives its chunk to another one. Workers may come
and go at any time. The scheduler needs the extra `cluster`.
"""

import multiprocessing
import os
import pickle
import signal
import sys
import threading
import warnings
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing import connection
from typing import Any

from contact.errors import ContactError, SceneError
from contact.extras import require, version
from contact.model.scene import Scene
from contact.search.topology.loop import Progress
from contact.sweeps.sweep.chunks import (
    CHUNKS,
    Chunk,
    Question,
    Rows,
    cannot_receive,
    failure,
    solve_sent,
    solved,
)

_ENDED = "the process that solved this point ended; it was probably killed or ran out of memory"
# Environment variables that limit the linear algebra libraries to one thread in each process.
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def processors() -> int:
    """The number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def solved_here(scene: Scene, chunks: Sequence[Chunk], tol: float) -> Generator[Rows]:
    """Yield the results (rows) of all points of the chunks, solved in this process one by one."""
    for chunk in chunks:
        for row in solved(scene, chunk, tol):
            yield [row]


def solved_in_processes(
    scene: Scene, chunks: Sequence[Chunk], tol: float, workers: int
) -> Generator[Rows]:
    """Yield the results (rows) of the chunks, solved in several processes, in any order."""
    _not_in_a_copy_of_the_script()
    waiting = deque(chunks)
    while waiting:
        with _pool(workers) as pool:
            given, why = _sent(pool, scene)
            if why:
                warnings.warn(
                    f"solved only in this process, because other processes {why}",
                    RuntimeWarning,
                    stacklevel=4,
                )
                break
            running: dict[Future[Rows], Chunk] = {}
            with suppress(BrokenProcessPool):
                while waiting or running:
                    while waiting and len(running) < workers:
                        running[_submitted(pool, solve_sent, given, waiting[0], tol)] = waiting[0]
                        waiting.popleft()
                    done = wait(running, return_when=FIRST_COMPLETED).done
                    # Successful chunks are handled first, since a failed chunk may mean that a
                    # process has died.
                    for future in sorted(done, key=lambda future: future.exception() is not None):
                        if why := _not_sent_back(future):
                            break
                        rows = future.result()
                        waiting.extendleft(running.pop(future).without(rows))
                        yield rows
                    if why:
                        break
        if why:
            warnings.warn(
                f"solved only in this process, because other processes {why}",
                RuntimeWarning,
                stacklevel=4,
            )
            waiting.extendleft(running.values())
            break
        yield from _point_by_point(given, list(running.values()), tol)
    yield from solved_here(scene, waiting, tol)


def _not_sent_back(future: Future[Rows]) -> str:
    """The reason why a worker process cannot send its solutions back; "" if it can.

    It cannot if an object of a class that the user wrote cannot be pickled.
    """
    error = future.exception()
    lost = isinstance(error, pickle.PicklingError) or (
        isinstance(error, (AttributeError, TypeError)) and "pickle" in str(error)
    )
    return f"cannot send solutions back ({type(error).__name__}: {error})" if lost else ""


def _sent(pool: ProcessPoolExecutor, scene: Scene) -> tuple[bytes, str]:
    """The scene as bytes, and the reason why other processes cannot use it, or "" if they can."""
    script = getattr(sys.modules["__main__"], "__file__", None)
    if script is not None and not os.path.exists(script):
        return b"", f"must import the script first, but {script} is not a file"
    try:
        given = pickle.dumps(scene)
    except Exception as error:
        return b"", f"cannot be sent the scene ({type(error).__name__}: {error})"
    try:
        return given, str(_submitted(pool, cannot_receive, given, version()).result())
    except BrokenProcessPool:
        return given, (
            "cannot be started: they import the script first, so put the code that calls contact "
            "under `if __name__ == '__main__':`"
        )


def _point_by_point(given: bytes, lost: Sequence[Chunk], tol: float) -> Generator[Rows]:
    """Yield the results (rows) of a dead process's chunks, solved one point at a time.
    They are solved in a separate process, which is replaced if it dies.
    """
    points = deque(point for chunk in lost for point in chunk.singly())
    while points:
        with _pool(1) as pool:
            while points:
                point = points.popleft()
                try:
                    yield _submitted(pool, solve_sent, given, point, tol).result()
                except BrokenProcessPool:
                    yield [(point.places[0], failure(_ENDED))]
                    break


@contextmanager
def _pool(workers: int) -> Iterator[ProcessPoolExecutor]:
    """A pool of worker processes, which end with the `with` block, also after an exception."""
    others = set(multiprocessing.active_children())
    pool = ProcessPoolExecutor(
        workers, multiprocessing.get_context("spawn"), initializer=_end_with_parent
    )
    try:
        yield pool
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in set(multiprocessing.active_children()) - others:
            process.terminate()
        raise
    pool.shutdown()


def _submitted(pool: ProcessPoolExecutor, *call: object) -> Future[Rows]:
    """Submit a call; a process started for this call has one thread and ignores Ctrl-C."""
    unset = [name for name in _THREADS if name not in os.environ]
    os.environ.update(dict.fromkeys(unset, "1"))
    handler = (
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        if threading.current_thread() is threading.main_thread()
        else None
    )
    try:
        return pool.submit(*call)  # type: ignore[arg-type]
    finally:
        if handler is not None:
            signal.signal(signal.SIGINT, handler)
        for name in unset:
            os.environ.pop(name, None)


def _end_with_parent() -> None:
    """Make a worker process exit when its parent is killed."""
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            connection.wait([parent.sentinel])
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _not_in_a_copy_of_the_script() -> None:
    """Exit silently in a worker process that is still importing the user's script.

    Without this, a script without `if __name__ == "__main__":` would start processes without end.
    """
    frame = sys._getframe()
    while frame.f_back is not None:
        frame = frame.f_back
        if frame.f_globals.get("__name__") == "__mp_main__" and frame.f_code.co_name == "<module>":
            raise SystemExit(1)


# Longest time to wait for the answer of a scheduler.
_CONNECTION_TIMEOUT = "10s"


class Cluster:
    """A connection to a Dask scheduler; a client given by the caller is not closed."""

    def __init__(self, scheduler: Any, progress: Progress | None) -> None:
        self._distributed = require("distributed")
        self._own = isinstance(scheduler, str)
        if not self._own and not isinstance(scheduler, self._distributed.Client):
            raise SceneError.of(
                "scheduler",
                scheduler,
                "None, the address of a Dask scheduler, or a dask.distributed.Client",
            )
        try:
            self._client = (
                self._distributed.Client(
                    scheduler, timeout=_CONNECTION_TIMEOUT, set_as_default=False
                )
                if self._own
                else scheduler
            )
        except Exception as error:  # any failure of the connection
            why = " ".join(str(error).split()) or type(error).__name__
            allowed = (
                f"the address of a Dask scheduler that answers, such as tcp://host:8786 ({why})"
            )
            raise SceneError.of("scheduler", scheduler, allowed) from error
        if not self._client.ncores():
            if progress is not None:
                progress("waiting for a worker", 0, None)
            self._client.wait_for_workers(1)

    @property
    def solvers(self) -> int:
        """Assumed number of threads of the cluster: more than now, because workers may join."""
        return CHUNKS.per_process * sum(self._client.ncores().values())

    def solved(self, scene: Scene, chunks: Sequence[Chunk], tol: float) -> Generator[Rows]:
        """Yield the results (rows) of the chunks, solved by the cluster's workers, in any order."""
        client = self._client
        # Unlike pickle, cloudpickle sends classes of the user's script by value, so that workers
        # need not import the script.
        scene_sent = require("cloudpickle").dumps(scene)
        self._ask(scene_sent)
        # The scene is a separate task, so that it is sent only once. It is sent again only if the
        # worker that holds it is lost.
        given = client.submit(_same, scene_sent, pure=False)
        running = {
            client.submit(solve_sent, given, chunk, tol, pure=False): chunk for chunk in chunks
        }
        try:
            # Each result is fetched as soon as it is ready. So it is not lost if its worker is lost
            # later.
            done = self._distributed.as_completed(
                list(running), loop=client.loop, with_results=True, raise_errors=False
            )
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
        """Raise ContactError if a worker cannot import what the scene needs.

        Without this check such a worker would die and the sweep would wait for others.
        """
        answers = self._client.run(pickle.loads, pickle.dumps(Question(given)), on_error="return")
        for worker, answer in answers.items():
            if answer:
                why = (
                    f"cannot import contact ({answer})"
                    if isinstance(answer, BaseException)
                    else answer
                )
                raise ContactError(f"the workers of the scheduler {why} (asked: {worker})")

    def _checked(self, future: Any, rows: Rows, chunk: Chunk) -> Rows:
        """The results (rows) of a task; if the task killed its workers, all rows are failures.

        Raises ContactError if the cluster itself failed.
        """
        if future.status == "finished":
            return rows
        if future.status != "error":
            raise ContactError(
                f"the scheduler was closed or gave up: the status of points is {future.status!r}"
            )
        error = future.exception()
        if isinstance(error, self._distributed.KilledWorker):
            return [
                (
                    place,
                    failure(
                        "every worker that tried to solve this point ended, probably because it "
                        "was killed or ran out of memory"
                    ),
                )
                for place in chunk.places
            ]
        raise ContactError(
            f"the workers of the scheduler cannot solve: {type(error).__name__}: {error}"
        )

    def close(self) -> None:
        if self._own:
            self._client.close()


def _same(given: bytes) -> bytes:
    return given
