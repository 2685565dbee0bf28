"""Ctrl-C in a command: one line and status 130, from the first module that is imported to the last
line that is printed.

While modules are imported KeyboardInterrupt is of no use: nothing is there yet to catch it, and
what it breaks off, half imported, may answer with another error or go on without it. There the
process ends at once; nothing has been computed or written by then. Only commands are handled so:
who imports `contact` keeps the signals as they are.
"""

import os
import signal
import sys
from types import FrameType

STATUS = 130

_started = False


def is_command() -> bool:
    """Whether this process is the command `contact` or `python -m contact`, told while the package
    is being imported.
    """
    name = os.path.basename(sys.argv[0]) if sys.argv else ""
    if name == "-m":  # where `python -m` still looks for the module
        given = sys.orig_argv
        return any(pair == ("-m", "contact") for pair in zip(given[1:], given[2:], strict=False))
    return name.removesuffix(".exe").removesuffix("-script.py") == "contact"


def install() -> None:
    """Take Ctrl-C, unless it is ignored, as in a job in the background, or someone else's."""
    try:
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, _interrupted)
    except ValueError:  # not the main thread
        pass


def started(now: bool = True) -> None:
    """From now on, or no longer, there is something that catches KeyboardInterrupt."""
    global _started
    _started = now


def stop() -> None:
    """End the process."""
    try:
        # A progress bar may have hidden the cursor.
        os.write(
            2, b"\x1b[?25h\rcontact: interrupted\n" if os.isatty(2) else b"contact: interrupted\n"
        )
    except OSError:
        pass
    os._exit(STATUS)


def importing(frame: FrameType | None) -> bool:
    """Whether the code that was broken off imports a module."""
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
