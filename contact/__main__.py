"""`python -m contact` and the console script `contact`: the command line."""

import sys

from contact import interrupts
from contact.errors import MissingExtra
from contact.extras import require


def main() -> None:
    """Run the command line.
    If optional packages for it are missing, print their names and exit with status 2.
    """
    interrupts.install()
    try:
        try:
            command_line = require("contact.commands.cli")
        except MissingExtra as error:
            print(f"contact: {error}", file=sys.stderr)
            raise SystemExit(2) from None
        interrupts.started()
        command_line.main(prog_name="contact")
    except KeyboardInterrupt:
        interrupts.stop()
    finally:
        interrupts.started(False)


if __name__ == "__main__":
    main()
