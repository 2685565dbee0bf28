"""Ctrl-C ends a command with one line and the status 130, whatever the command is doing."""

from __future__ import annotations

import importlib
import os
import signal
import subprocess
import sys
import threading
from functools import partial
from pathlib import Path

import pytest

from contact import interrupts
from tests.tiers import quick

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
pytest.importorskip("click")


def interrupted(
    folder: Path, after: str, command: tuple[str, ...] = ("-m", "contact")
) -> subprocess.CompletedProcess[str]:
    """The result of a command that was interrupted once it had imported the module `after`.
    The scene file of the command is a named pipe, for which the command waits without end.
    """
    os.mkfifo(folder / "scene.toml")
    arguments = [sys.executable, "-X", "importtime", *command, "solve", str(folder / "scene.toml")]
    # A shell lets tests in the background ignore SIGINT, and child processes inherit this. So
    # the default handler is restored.
    heard = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    with subprocess.Popen(
        arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=heard
    ) as process:
        assert process.stderr is not None and process.stdout is not None
        # If the module is not imported any more, the command is killed after this time.
        watch = threading.Timer(60.0, process.kill)
        watch.start()
        for line in process.stderr:
            if line.startswith("import time:") and line.rpartition("|")[2].strip() == after:
                break
        process.send_signal(signal.SIGINT)
        said = [line for line in process.stderr if not line.startswith("import time:")]
        out = process.stdout.read()
        watch.cancel()
    return subprocess.CompletedProcess(arguments, process.returncode, out, "".join(said))


@pytest.mark.parametrize(
    "module",
    quick(
        ["contact.interrupts", "numpy", "contact", "contact.solution.terminal"],
        ["contact.interrupts", "contact.solution.terminal"],
    ),
)
def test_a_command_is_interrupted_at_any_import(tmp_path: Path, module: str) -> None:
    done = interrupted(tmp_path, module)
    assert (done.returncode, done.stdout, done.stderr.strip()) == (130, "", "contact: interrupted")


def test_the_installed_command_is_interrupted_too(tmp_path: Path) -> None:
    script = tmp_path / "contact"
    script.write_text("import sys\nfrom contact.__main__ import main\nsys.exit(main())\n")
    done = interrupted(tmp_path, "numpy", (str(script),))
    assert (done.returncode, done.stdout, done.stderr.strip()) == (130, "", "contact: interrupted")


def test_importing_the_package_keeps_the_handler_of_the_signal() -> None:
    assert not interrupts.is_command()
    # The signal is ignored where tests run in the background of a shell.
    assert signal.getsignal(signal.SIGINT) in (signal.default_int_handler, signal.SIG_IGN)


def test_a_frame_below_an_import_is_recognized(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "imported_for_its_frame.py").write_text("import sys\nframe = sys._getframe()\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert interrupts.importing(importlib.import_module("imported_for_its_frame").frame)
    assert not interrupts.importing(None)
