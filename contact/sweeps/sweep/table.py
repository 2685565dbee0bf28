"""The table of a sweep: the results at all points of the grid, and why points failed.

The table is returned as an xarray.Dataset and stored in a netCDF file that a later sweep can
continue. Only one sweep at a time may use a file: two would overwrite each other's results.
"""

import hashlib
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np

from contact.errors import SceneError, shown
from contact.extras import require, version
from contact.model.controls import TURNING
from contact.model.scene import Scene
from contact.solution.export import is_long, plain
from contact.sweeps.points import NUMBERS
from contact.sweeps.sweep.chunks import Rows
from contact.sweeps.sweep.keys import BRANCH, BRANCHES, Axis, name_of
from contact.sweeps.sweep.keys import tables as tables_of
from sie import Mask

_WORDS = {"reason": "why a point failed", "warning": "warnings of the solution"}


class Table:
    """Results of all points as flat arrays; nan for points that are not solved yet."""

    def __init__(
        self, scene: Scene, axes: Sequence[Axis], tol: float, branch: str = BRANCHES[0]
    ) -> None:
        self.axes, self.tol, self.branch = tuple(axes), tol, branch
        self.scene = description(scene, {axis.key for axis in axes})
        if branch != BRANCHES[0] and not any(axis.key == BRANCH for axis in axes):
            self.scene["control"][BRANCH] = branch
        self.shape = tuple(len(axis.values) for axis in axes)
        size = int(np.prod(self.shape))
        self.numbers = {name: np.full(size, np.nan) for name in NUMBERS}
        self.words = {name: np.full(size, "", dtype=object) for name in _WORDS}
        self.failed = np.zeros(size, dtype=bool)

    @property
    def size(self) -> int:
        return int(self.failed.size)

    @property
    def solved(self) -> Mask:
        """Mask of the points whose stated error is within the tolerance."""
        with np.errstate(invalid="ignore"):
            return np.asarray(self.numbers["error"] <= self.tol)

    def put(self, rows: Rows) -> None:
        for place, row in rows:
            for name, values in (*self.numbers.items(), *self.words.items()):
                values[place] = row[name]
            self.failed[place] = row["failed"]

    def point(self, place: int) -> str:
        """Text that names the varied keys and their values at one point of the grid."""
        index = np.unravel_index(place, self.shape)
        return ", ".join(
            f"{axis.key} = {axis.values[i]}" for axis, i in zip(self.axes, index, strict=True)
        )

    def to_dataset(self) -> Any:
        """An xarray.Dataset of the results on the grid, with units.

        A dimension has the name of its key with "_" for "."; its attribute `key` is the key.
        """
        dims = [axis.name for axis in self.axes]
        data: dict[str, Any] = {
            name: (
                dims,
                self.numbers[name].reshape(self.shape),
                {"units": unit, "long_name": label},
            )
            for name, (unit, label) in NUMBERS.items()
        }
        data["failed"] = (
            dims,
            self.failed.reshape(self.shape),
            {"long_name": "whether there is no solution"},
        )
        data |= {
            name: (dims, self.words[name].reshape(self.shape), {"long_name": label})
            for name, label in _WORDS.items()
        }
        coordinates = {
            axis.name: (axis.name, np.array(axis.values), _described(axis)) for axis in self.axes
        }
        attributes = {
            "title": "elastic contact over a grid",
            "source": f"sie-contact {version()}",
            "version": version(),
            "tol": self.tol,
            "scene": json.dumps(self.scene),
        }
        return require("xarray").Dataset(data, coords=coordinates, attrs=attributes)

    def save(self, path: Path) -> None:
        """Write the file in one step, so that no reader sees a half-written file."""
        temporary = path.with_name(f".{path.name}.{os.getpid()}")
        try:
            self.to_dataset().to_netcdf(temporary, engine="h5netcdf")
            os.replace(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)

    def take_over(self, path: Path) -> None:
        """Copy the results of an earlier sweep from a file into this table.
        Raises SceneError unless the file belongs to the same scene and its points are on this grid.
        """
        known = _read(path)
        dims = [axis.name for axis in self.axes]
        if sorted(map(str, known.dims)) != sorted(dims):
            there = ", ".join(str(known[name].attrs.get("key", name)) for name in known.dims)
            here = ", ".join(axis.key for axis in self.axes)
            raise self._other(path, f"over {there}", f"not over {here}")
        self._same_scene(path, json.loads(known.attrs["scene"]))
        known = known.transpose(*dims)
        places = []
        for axis in self.axes:
            there = known[axis.name].values.tolist()
            for value in there:
                if value not in axis.values:
                    raise self._other(
                        path, f"at {axis.key} = {value!r}", "which is not among the values given"
                    )
            places.append([axis.values.index(value) for value in there])
        flat = np.ravel_multi_index(np.ix_(*places), self.shape).ravel()
        for name, values in (*self.numbers.items(), *self.words.items()):
            values[flat] = known[name].values.ravel()
        self.failed[flat] = known["failed"].values.astype(bool).ravel()

    def _same_scene(self, path: Path, there: Mapping[str, Any]) -> None:
        for table in dict.fromkeys([*there, *self.scene]):
            old, new = there.get(table, {}), self.scene.get(table, {})
            for key in dict.fromkeys([*old, *new]):
                there_is, here_is = old.get(key), new.get(key)
                if there_is != here_is:
                    raise self._other(
                        path,
                        f"with {table}.{key} = {shown(there_is)}",
                        f"where the scene has {shown(here_is)} now",
                    )

    def _other(self, path: Path, there: str, here: str) -> SceneError:
        allowed = (
            f"a file of this scene and grid: its points are {there}, {here}; "
            "name another file, or use overwrite=True (--overwrite) to replace this one"
        )
        return SceneError.of("out", str(path), allowed)


def _described(axis: Axis) -> dict[str, str]:
    """Attributes of an axis of the sweep, for its coordinate in an xarray data set."""
    described = {"key": axis.key, "long_name": axis.key}
    return {**described, "units": axis.unit} if axis.unit else described


def _read(path: Path) -> Any:
    try:
        with require("xarray").open_dataset(path, engine="h5netcdf") as opened:
            # In files of earlier versions, the names of the dimensions are the keys with the dot.
            known = opened.rename({name: name_of(str(name)) for name in opened.dims}).load()
        missing = {*NUMBERS, *_WORDS, "failed"} - set(known.data_vars) or {"scene"} - set(
            known.attrs
        )
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise SceneError.of(
            "out", str(path), f"a file that a sweep has written ({' '.join(str(error).split())})"
        ) from error
    if missing:
        raise SceneError.of(
            "out",
            str(path),
            f"a file that a sweep has written ({', '.join(sorted(missing))} missing)",
        )
    return known


def description(scene: Scene, but: set[str]) -> dict[str, dict[str, Any]]:
    """The tables of a scene without the keys in `but`; long arrays are given by shape and hash."""
    tables: dict[str, dict[str, Any]] = {"material": {"E_star": scene.E_star}}
    for table, values in tables_of(scene).items():
        body = scene.profile.bodies.get(table)
        part = getattr(scene, table) if body is None else body
        name = {"model" if body is None else "shape": part.name or type(part).__qualname__}
        if body is not None:
            prepared = {f"{table}.{key}" for key in body.preparation}
            # A trace is described by its prepared points. If the sweep varies the preparation, it
            # is described by the points before the preparation.
            hidden = (
                set()
                if prepared & but - {f"{table}.period"}
                else set(body.preparation) - set(body.parameters())
            )
            values = {
                **{key: value for key, value in values.items() if key not in hidden},
                **({} if hidden else body.unprepared()),
            }
        tables[table] = {**name, **{key: _short(value) for key, value in values.items()}}
    replaced = any(
        key.startswith("control.") and key.removeprefix("control.") not in TURNING for key in but
    )
    tables["control"] = scene.turning if replaced else dict([scene.control], **scene.turning)
    return {
        table: {key: value for key, value in values.items() if f"{table}.{key}" not in but}
        for table, values in tables.items()
    }


def _short(value: Any) -> Any:
    if callable(value):
        # A function is described by its name, since its memory address changes from run to run.
        name = getattr(value, "__qualname__", type(value).__qualname__)
        return f"{getattr(value, '__module__', '')}.{name}"
    if not is_long(value):
        return plain(value)
    array = np.ascontiguousarray(value)
    data = array.tobytes() if array.dtype.kind in "biufc" else repr(array.tolist()).encode()
    return f"array of shape {array.shape}, sha256 {hashlib.sha256(data).hexdigest()[:16]}"


@contextmanager
def alone(path: Path) -> Iterator[None]:
    """Lock a file against other sweeps; raises SceneError if another sweep has locked it.

    The operating system releases the lock when the process ends, however it ends. Other machines
    see the lock if their file system supports it.
    """
    # All names (links) of a file share one lock, at the file's resolved path.
    real = path.resolve()
    if not os.access(real.parent, os.W_OK):
        raise SceneError.of("out", str(path), "a file in a folder that can be written to")
    filelock = require("filelock")
    lock = filelock.FileLock(real.with_name(f".{real.name}.lock"), blocking=False)
    try:
        lock.acquire()
    except filelock.Timeout as error:
        raise SceneError.of(
            "out",
            str(path),
            "a file that no other sweep is writing; wait for the other sweep, or name another file",
        ) from error
    try:
        yield
    finally:
        # The lock file is removed before the lock is released. A process that has already opened
        # the file notices that it was removed, and creates a new lock file.
        with suppress(OSError):
            os.unlink(lock.lock_file)
        lock.release()
