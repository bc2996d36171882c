"""``python -m pliant``: the command line."""

from pliant.cli.__main__ import main

if __name__ == "__main__":
    main()
