"""`python -m contact`, and the console script: the command line, or one line that says what it lacks."""

from __future__ import annotations

import sys

from contact import lazy
from contact.errors import MissingExtra


def main() -> None:
    """Run the command line; its packages are an extra, and without them this is the only place that can say so."""
    try:
        command_line = lazy.command_line()
    except MissingExtra as error:
        print(f"contact: {error}", file=sys.stderr)
        raise SystemExit(2) from None
    command_line.main(prog_name="contact")


if __name__ == "__main__":
    main()
