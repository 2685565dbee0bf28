"""Tables on stdout and a progress bar on stderr."""

import sys
import time
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from contact.errors import MissingExtra
from contact.extras import require


def show_table(
    title: str,
    columns: Sequence[str],
    rows: Iterable[Sequence[str]],
    numeric: Iterable[int] = (),
    close: bool = False,
    file_width: int = 200,
) -> None:
    """Print a table, in which the `numeric` columns are aligned to the right.

    close: one blank between columns instead of three. file_width: number of characters in a line if
    the output is no terminal; it is so large that no cell is broken.
    """
    right = set(numeric)
    padding = (0, 0) if close else (0, 1)
    table = require("rich.table").Table(
        title=title, title_justify="left", box=require("rich.box").SIMPLE_HEAD, padding=padding
    )
    for place, name in enumerate(columns):
        table.add_column(name, justify="right" if place in right else "left", overflow="fold")
    for row in rows:
        table.add_row(*row)
    width = None if sys.stdout.isatty() else file_width
    # `markup=False`: square brackets in a reason or a unit are plain text, not markup of the
    # package rich.
    require("rich.console").Console(
        file=sys.stdout, width=width, markup=False, highlight=False
    ).print(table)


def show_columns(
    title: str,
    columns: Sequence[tuple[str, Sequence[str]]],
    words: Iterable[int] = (),
    close: bool = False,
) -> None:
    """Print a table given as columns (name, cells); the columns `words` align to the left."""
    names, cells = zip(*columns, strict=True)
    show_table(
        title, names, zip(*cells, strict=True), set(range(len(names))).difference(words), close
    )


class Progress:
    """A callable for `contact.solve(progress=...)` that shows a progress bar on stderr.

    The bar appears on a terminal only, once the work has lasted `patience` seconds.
    """

    def __init__(
        self,
        patience: float = 1.0,
        clock: Callable[[], float] = time.monotonic,
        wanted: bool = True,
    ) -> None:
        self._due = clock() + patience
        self._clock = clock
        self._wanted = wanted and sys.stderr.isatty()
        self._bar: Any = None
        self._task: Any = None
        self._stage = ""

    def __call__(self, stage: str, done: int, total: int | None) -> None:
        if not self._wanted or (self._bar is None and self._clock() < self._due):
            return
        if self._bar is None and not self._start():
            return
        if self._task is None or stage != self._stage:
            if self._task is not None:
                self._bar.remove_task(self._task)
            self._task, self._stage = self._bar.add_task(stage, total=total), stage
        self._bar.update(self._task, completed=done, total=total)

    def say(self, line: str) -> None:
        """Print an intermediate result on stderr, above the progress bar."""
        if self._bar is None:
            print(line, file=sys.stderr, flush=True)
        else:
            self._bar.console.print(line, markup=False, highlight=False)

    def _start(self) -> bool:
        """Start the progress bar and return True; return False if the package rich is missing."""
        try:
            console = require("rich.console").Console(file=sys.stderr)
            self._bar = require("rich.progress").Progress(console=console, transient=True)
        except MissingExtra:  # the work goes on without a bar
            self._wanted = False
        else:
            self._bar.start()
        return self._wanted

    def __enter__(self) -> "Progress":
        return self

    def __exit__(self, *raised: object) -> None:
        if self._bar is not None:
            self._bar.stop()
            self._bar = None
