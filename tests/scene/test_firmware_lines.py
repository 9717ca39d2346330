"""Every executable line of the shipped Python firmware runs in a shipped case.

timing/ and its folders --each case for a while, lines traced--> lines of firmware/python that ran
"""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from inspect import CO_OPTIMIZED
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

from periph_sim import Scene, form, load
from periph_sim.interfaces.reports.profile import covered_files, profiled
from tests.scene.runs import TIMING

FIRMWARE = TIMING.parent / "firmware" / "python"
FOLDER = f"{FIRMWARE}/"
CASES = [path for folder in ("variants", ".", "trade", "forum") for path in sorted((TIMING / folder).glob("*.toml"))]
SECONDS = Fraction(6, 100)
LONGER = {  # the first fault that runs a line is later, and the EEPROM has no power in the fourth round
    "imu_hil_broken_line": "0.12",
    "imu_hil_module_reset": "0.41",
    "imu_hil_glitches": "0.47",
    "eeprom_faults": "0.1",
}
IMAGES = [path for path in CASES if path.stem.startswith("image_") or path.stem == "imu_hil_image"]
BY_OBJECT_ONLY = ["imu_models.py: return value"]  # parameters given as an object, which a case cannot do


def executable(path: Path) -> set[int]:
    """Return the lines of functions that a case can run.

    Lines of a `raise` are left out: they refuse a setting before the case runs. Lines of modules and classes run as the
    firmware is imported, which an earlier test may have done.
    """
    waiting: list[CodeType] = [compile(path.read_text(encoding="utf-8"), str(path), "exec")]
    found: set[int] = set()
    while waiting:
        code = waiting.pop()
        if (
            code.co_flags & CO_OPTIMIZED and code.co_name != "__annotate__"
        ):  # a function, but not that of Python 3.14 for a class
            found |= {line for _, _, line in code.co_lines() if line}
        waiting += [each for each in code.co_consts if isinstance(each, CodeType)]
    tree = ast.parse(path.read_text(encoding="utf-8"))
    refused = [node for node in ast.walk(tree) if isinstance(node, ast.Raise | ast.ExceptHandler) or _declares(node)]
    return found - {line for node in refused for line in range(node.lineno, (node.end_lineno or 0) + 1)}


def _declares(node: ast.AST) -> bool:
    """Return True for a method of a protocol, which has no code of its own."""
    return isinstance(node, ast.FunctionDef) and all(isinstance(one, ast.Expr | ast.Raise) for one in node.body)


@contextmanager
def traced(ran: dict[str, set[int]]) -> Iterator[None]:
    """Add the lines of firmware that run in the block to `ran`, by file name."""

    def of_call(frame: FrameType, event: str, argument: object) -> Any:
        path = frame.f_code.co_filename
        if not path.startswith(FOLDER):
            return None
        lines = ran[path.removeprefix(FOLDER)]
        lines.add(frame.f_lineno)

        def of_line(frame: FrameType, event: str, argument: object) -> Any:
            lines.add(frame.f_lineno)
            return of_line

        return of_line

    before = sys.gettrace()
    sys.settrace(of_call)
    try:
        yield
    finally:
        sys.settrace(before)


def never_run() -> list[str]:
    """Return the lines that no case runs. A case is left out once each line of its firmware has run."""
    ran: dict[str, set[int]] = defaultdict(set)
    lines = {path.name: executable(path) for path in FIRMWARE.glob("*.py")}
    for path in CASES:
        case = load(path, [])
        programs = {f"{unit.firmware}.py" for unit in case.unit.values() if unit.firmware}
        if case.outside is None and any(lines[program] - ran[program] for program in programs):
            with traced(ran):
                Scene(case).run(min(Fraction(LONGER.get(path.stem, SECONDS)), case.duration))
    return [
        f"{name}: {(FIRMWARE / name).read_text(encoding='utf-8').splitlines()[line - 1].strip()}"
        for name in sorted(lines)
        for line in sorted(lines[name] - ran[name])
    ]


def test_every_line_of_shipped_firmware_runs_in_a_case():
    """The cases run in a process of their own, since firmware that ran before keeps what it has computed."""
    code = "from tests.scene.test_firmware_lines import never_run; print(*never_run(), sep='\\n')"
    quickest = {name: value for name, value in os.environ.items() if name != form.VARIABLE}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=TIMING.parent, env=quickest, capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines() == BY_OBJECT_ONLY


def test_every_line_of_shipped_machine_code_runs_in_a_case():
    ran: dict[Path, dict[int, int]] = defaultdict(dict)
    for path in IMAGES:
        run = profiled(load(path, []), Fraction("0.03") if path.stem == "imu_hil_image" else None, coverage=True)
        found = covered_files(run)
        for file, of_file in found.items():
            lines = ran[Path(file).resolve()]
            for line, count in of_file.lines.items():
                lines[line] = lines.get(line, 0) + count
    assert {file.name for file in ran} >= {path.name for path in (FIRMWARE.parent / "c28x").glob("*.asm")}
    assert {f"{file.name}:{line}" for file, lines in ran.items() for line, count in lines.items() if not count} == set()
