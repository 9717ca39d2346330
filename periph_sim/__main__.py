"""`periph-sim`, and `python -m periph_sim`: the command line, in a process that another one waits for."""

from __future__ import annotations

import gc
from typing import NoReturn

from .supervisor import supervise


def command_line() -> None:
    gc.disable()  # until the command is imported, since what is imported stays
    from .cli import run_command

    run_command()


def main() -> NoReturn:
    """Entry point of `periph-sim`."""
    supervise(command_line, "periph-sim")


if __name__ == "__main__":
    main()
