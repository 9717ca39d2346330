"""Run the tests of the compiled modules again, interpreted: `python -m tests.interpreted [PYTEST OPTIONS]`.

    compiled modules --> the corresponding folders of tests --> pytest, in a process with the interpreted core

Within these folders, those of packages without compiled modules are left out. After `make test` and `make interpreted`
the compiled modules have been tested in both forms. Without a compiled core there is nothing to do, because the whole
suite ran interpreted. Tests of the builds choose the form themselves, and are not run again.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

from periph_sim import form

TESTS = Path(__file__).parent


def folders(modules: Iterable[str]) -> list[str]:
    """Return folders, none within another: ["bus.i2c.monitor", "core.fifo"] --> ["tests/bus/i2c", "tests/core"]."""
    rooms = {room for module in modules for room in [_with_tests(module.split(".")[:-1])] if room.parts}
    return sorted(f"tests/{room.as_posix()}" for room in rooms if not rooms.intersection(room.parents))


def left_out(modules: Iterable[str]) -> list[str]:
    """Return the folders within these of packages without compiled modules, none within another."""
    compiled = [module.replace(".", "/") for module in modules]
    inner = [path.relative_to(TESTS) for one in folders(modules) for path in (TESTS.parent / one).rglob("*/")]
    rooms = {
        room
        for room in inner
        if (form.PACKAGE / room / "__init__.py").is_file()
        and not any(module.startswith(f"{room.as_posix()}/") for module in compiled)
    }
    return sorted(f"tests/{room.as_posix()}" for room in rooms if not rooms.intersection(room.parents))


def _with_tests(names: list[str]) -> Path:
    """Return the folder of a package, or the nearest one above it, that has tests."""
    room = Path(*names)
    while not (TESTS / room).is_dir():
        room = room.parent
    return room


def main(options: list[str]) -> int:
    modules, _ = form.usable(form.PACKAGE, form.BUILT)
    if not modules:
        print("no core is compiled of these sources, so there is nothing to run again")
        return 0
    ignored = [f"--ignore={folder}" for folder in left_out(modules)]
    command = [sys.executable, "-m", "pytest", *options, *ignored, *folders(modules)]
    return subprocess.run(command, env={**os.environ, form.VARIABLE: form.INTERPRETED}, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
