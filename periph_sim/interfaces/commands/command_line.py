"""The command as it was typed, for outputs that name their command."""

from __future__ import annotations

import shlex
import sys


def command_line() -> str:
    """Return the command line, as "periph-sim run timing/imu_hil.toml --seconds 1", without the program's folder."""
    return shlex.join(["periph-sim", *sys.argv[1:]])
