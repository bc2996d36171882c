"""The entry point: runs a command, and turns what nobody expected into one line and exit code 1."""

from __future__ import annotations

import sys
import traceback

from pliant.cli.exits import Exit


def main() -> None:
    """Run the command line; never returns."""
    from pliant.cli.app import app

    try:
        app()
    except Exception as error:
        if "--debug" in sys.argv[1:]:
            traceback.print_exc()
        cause = " ".join(str(error).split())
        print(
            f"error: this is a bug in pliant: {type(error).__name__}: {cause}\n"
            "Please report it with the command and, if you can, the file; "
            "'pliant --debug ...' shows where it happened.",
            file=sys.stderr,
        )
        sys.exit(Exit.BUG)


if __name__ == "__main__":
    main()
