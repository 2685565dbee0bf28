"""A scene on a grid of values of its parameters, solved in many processes."""

import itertools
import time
from collections.abc import Generator, Mapping, Sequence
from contextlib import closing, nullcontext
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from contact.errors import SceneError, warn
from contact.extras import require
from contact.model.checks import integer, one_of
from contact.model.scene import Scene
from contact.search.topology.loop import Progress
from contact.solution.export import new_file
from contact.solver import tolerance
from contact.sweeps.sweep.chunks import Rows, chunks_of
from contact.sweeps.sweep.keys import BRANCHES, Axis, axes_of, varied
from contact.sweeps.sweep.processes import Cluster, processors, solved_here, solved_in_processes
from contact.sweeps.sweep.table import Table, alone
from sie import Mask


@dataclass(frozen=True)
class SavingOptions:
    """Limit on the time that is spent on writing the table while a sweep runs."""

    # Largest fraction of the running time that is spent on writing.
    max_share: float = 0.02


_SAVING = SavingOptions()


def sweep(
    scene: Scene,
    over: Mapping[str, Any],
    scheduler: Any = None,
    tol: float = 1e-8,
    *,
    workers: int | None = None,
    out: str | PathLike[str] | None = None,
    overwrite: bool = False,
    retry: bool = False,
    branch: str = BRANCHES[0],
    progress: Progress | None = None,
) -> Any:
    """Solve a scene on a grid of values of its parameters, in several processes or on a cluster.

    Points that differ only in the value of a control share work, as in `contact.solve_many`. A
    point that fails is marked as failed; the others are solved. With `out`, finished points are
    written to a file while the sweep runs, and points already in the file are not solved again.

    Parameters
    ----------
    scene : Scene
        The scene.
    over : mapping
        Lists of values by key. Keys are those of scene files, such as "control.mean_pressure",
        "profile.amplitude", "material.E_star" or "substrate.thickness". Values are numbers, or
        words if the parameter is a word. A control replaces the scene's own control.
    scheduler : str, dask.distributed.Client or None
        Address (or client) of a Dask scheduler; None: processes of this machine.
    tol : float
        Largest stated error of each solution.
    workers : int or None
        Number of processes; None: one per processor; 1: this process only.
    out : str, path or None
        A netCDF file (.nc) to write; an existing one is continued. One sweep at a time may use it.
    overwrite : bool
        Whether an existing file is replaced and every point is solved anew.
    retry : bool
        Whether points marked as failed in the file are tried again.
    branch : str
        The branch of equilibria, as for `contact.solve`, unless `over` varies it.
    progress : callable or None
        Called with ("points", done, total).

    Returns
    -------
    xarray.Dataset
        The dimensions are named after the keys with "_" for ".", such as `profile_amplitude`, whose
        attribute `key` is "profile.amplitude". The variables are load, mean_pressure, max_pressure,
        approach, contact_fraction, total_width, stiffness, mean_gap, zone_count (0 in full contact)
        and error, in SI units. They are nan at failed points, or if the scene does not define them.
        Further variables are `failed`, and the texts `reason` and `warning`.

    Raises
    ------
    SceneError
        If a key or value is not valid for the scene, if the scheduler does not answer, or if the
        file belongs to another scene, has other points, or is in use by another sweep.
    MissingExtra
        Without xarray, or with a scheduler without Dask.

    Warns
    -----
    ModelWarning
        If points failed, or if the model is doubtful at some of them.

    Examples
    --------
    >>> import contact
    >>> wave = contact.Scene(contact.Sinusoid(1e-6, 1e-4), 1e9, contact.Periodic(), load=1.0)
    >>> over = {"profile.amplitude": [1e-6, 2e-6], "control.contact_fraction": [0.2, 0.4, 0.6]}
    >>> table = contact.sweep(wave, over, workers=1)
    >>> dict(table.sizes), bool(table.failed.any())
    ({'profile_amplitude': 2, 'control_contact_fraction': 3}, False)
    >>> float((table["load"][1] / table["load"][0]).max().round(6))
    2.0
    """
    if not isinstance(scene, Scene):
        raise SceneError.of("scene", scene, "a contact.Scene")
    require("xarray")
    axes = axes_of(scene, over)
    _check_values(scene, axes)
    table = Table(scene, axes, tolerance(tol), one_of("branch", branch, BRANCHES))
    path = None if out is None else _checked(out)
    with nullcontext() if path is None else alone(path):
        if path is not None and path.exists() and not overwrite:
            table.take_over(path)
        cluster = None if scheduler is None else Cluster(scheduler, progress)
        solvers = (
            cluster.solvers
            if cluster
            else processors()
            if workers is None
            else integer("workers", workers, 1)
        )
        try:
            _fill(
                table,
                path,
                _solving(scene, table, cluster, solvers, retry),
                progress,
                table.size - int(_wanted(table, retry).sum()),
            )
        finally:
            if cluster:
                cluster.close()
    _tell(table)
    return table.to_dataset()


def _solving(
    scene: Scene, table: Table, cluster: Cluster | None, solvers: int, retry: bool
) -> Generator[Rows]:
    """Yield the results (rows) of all points of the table that are still to be solved."""
    wanted = _wanted(table, retry)
    # A single process hands over its results one by one, so its curves need not be cut into chunks.
    chunks = chunks_of(
        table.axes, wanted, solvers if cluster or solvers > 1 else None, table.branch
    )
    if cluster:
        return cluster.solved(scene, chunks, table.tol)
    if min(solvers, len(chunks)) <= 1:
        return solved_here(scene, chunks, table.tol)
    return solved_in_processes(scene, chunks, table.tol, min(solvers, len(chunks)))


def _wanted(table: Table, retry: bool) -> Mask:
    """Mask of the points to solve: all unsolved points; failed points only with `retry`."""
    return np.asarray(~table.solved & (~table.failed | retry))


def _fill(
    table: Table, path: Path | None, solving: Generator[Rows], progress: Progress | None, done: int
) -> None:
    """Put rows of results into the table.
    The table is saved repeatedly, and finally when the sweep ends or fails.
    """
    due = time.monotonic()
    try:
        with closing(solving):
            for rows in solving:
                table.put(rows)
                done += len(rows)
                if progress is not None:
                    progress("points", done, table.size)
                if path is not None and time.monotonic() > due:
                    start = time.monotonic()
                    table.save(path)
                    end = time.monotonic()
                    due = end + (end - start) / _SAVING.max_share
    finally:
        if path is not None:
            table.save(path)


def _check_values(scene: Scene, axes: Sequence[Axis]) -> None:
    """Raise SceneError if a value of one axis is invalid for all values of the other axes."""
    for number, axis in enumerate(axes):
        for value in axis.values:
            first: SceneError | None = None
            others = [
                axis.values if place != number else (value,) for place, axis in enumerate(axes)
            ]
            for point in itertools.product(*others):
                try:
                    varied(scene, dict(zip((axis.key for axis in axes), point, strict=True)))
                    break
                except SceneError as error:
                    first = first or error
            else:
                assert first is not None
                raise SceneError(
                    f"{axis.key} = {value!r}: {first}", axis.key, value, first.allowed
                ) from first


def _checked(out: str | PathLike[str]) -> Path:
    """The path of the netCDF file, after a check of its name and of the needed packages."""
    # An existing file is allowed, since the sweep continues it.
    path = new_file(out, True, (".nc",), "out")
    for needed in ("h5netcdf", "h5py", "filelock"):
        require(needed)
    return path


def _tell(table: Table) -> None:
    """Warn once about all failed points, and once about all points that have a `warning`."""
    failed, odd = np.flatnonzero(table.failed), np.flatnonzero(table.words["warning"] != "")
    lines = [
        f"{len(places)} of {table.size} points {what}: "
        f"at {table.point(places[0])}: {table.words[word][places[0]]}"
        for places, word, what in ((failed, "reason", "failed"), (odd, "warning", "have warnings"))
        if len(places)
    ]
    warn(lines, stacklevel=4)
