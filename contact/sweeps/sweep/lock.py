"""One sweep at a time writes a file: two would each write over what the other has solved."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from contact.errors import SceneError
from contact.extras import require


@contextmanager
def alone(path: Path) -> Iterator[None]:
    """Hold the file of a name against other sweeps, of this process, of this machine or, where file systems tell, of others; SceneError
    where one holds it already.

    The system lets go of what a process holds when that ends, however it ends.
    """
    # Whatever name a file goes by, its lock has one.
    real = path.resolve()
    if not os.access(real.parent, os.W_OK):
        raise SceneError.of("out", str(path), "a file in a folder that can be written to")
    filelock = require("filelock")
    lock = filelock.FileLock(real.with_name(f".{real.name}.lock"), blocking=False)
    try:
        lock.acquire()
    except filelock.Timeout as error:
        raise SceneError.of("out", str(path), "a file that no other sweep is writing: one is, and goes on; name another file") from error
    try:
        yield
    finally:
        # Taken away while it is held: who has opened it meanwhile sees that it is gone, and makes a new one.
        with suppress(OSError):
            os.unlink(lock.lock_file)
        lock.release()
