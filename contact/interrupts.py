"""Ctrl-C in a command prints one line and exits with status 130, at any moment of its run.

During an import, KeyboardInterrupt does not work: no code catches it yet, and a half-imported
module may raise another error or ignore it. So Ctrl-C during an import ends the process at once;
nothing has been computed or written by then. Only the commands handle Ctrl-C this way: a program
that imports `contact` keeps its own signal handlers.
"""

import os
import signal
import sys
from enum import IntEnum
from types import FrameType


class ExitStatus(IntEnum):
    """Exit status of a command that ends without a result."""

    BAD_INPUT = 2
    NOT_CONVERGED = 3
    INTERRUPTED = 130


_started = False


def is_command() -> bool:
    """Whether this process is the command `contact` or `python -m contact`."""
    name = os.path.basename(sys.argv[0]) if sys.argv else ""
    if name == "-m":  # `python -m` has not yet replaced argv[0] by the module's file
        given = sys.orig_argv
        return any(pair == ("-m", "contact") for pair in zip(given[1:], given[2:], strict=False))
    return name.removesuffix(".exe").removesuffix("-script.py") == "contact"


def install() -> None:
    """Handle Ctrl-C by `_interrupted`, unless the process ignores it or has its own handler.

    Background jobs ignore Ctrl-C.
    """
    try:
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, _interrupted)
    except ValueError:  # not the main thread
        pass


def started(now: bool = True) -> None:
    """Set `_started` to `now`: whether the command line catches KeyboardInterrupt."""
    global _started
    _started = now


def stop() -> None:
    """Print one line and end the process with the exit status 130."""
    try:
        # Show the cursor again, which a progress bar may have hidden.
        os.write(
            2, b"\x1b[?25h\rcontact: interrupted\n" if os.isatty(2) else b"contact: interrupted\n"
        )
    except OSError:
        pass
    os._exit(ExitStatus.INTERRUPTED)


def importing(frame: FrameType | None) -> bool:
    """Whether the interrupted code was importing a module."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def _interrupted(_: int, frame: FrameType | None) -> None:
    if not _started or importing(frame):
        stop()
    raise KeyboardInterrupt


if is_command():
    install()
