"""Start of `periph-sim` and `python -m periph_sim`: the command line runs in a worker process (see `supervisor`)."""

from __future__ import annotations

import gc
from typing import NoReturn

from .supervisor import supervise


def command_line() -> None:
    gc.disable()  # garbage collection during imports only costs time; `get_command` enables it again after them
    from .cli import run_command

    run_command()


def main() -> NoReturn:
    """Entry point of `periph-sim`."""
    supervise(command_line, "periph-sim")


if __name__ == "__main__":
    main()
