"""A case whose frames do not overlap with a round in an ordinary run, and a coverage file of phases at which they do.

rounds          R----------R----------
frames, as run  ---F----------F-------    the interrupt comes while the firmware is idle
coverage        ----------F----------F    the interrupt comes while the controller waits for the first byte
"""

from __future__ import annotations

import json
from contextlib import chdir
from fractions import Fraction
from pathlib import Path
from typing import Any

from msgspec.structs import replace

from periph_sim.interfaces.reports.baselines.check import check
from periph_sim.interfaces.reports.coverage import choose, run_coverage
from periph_sim.proof.saved_paths import coverage_path
from periph_sim.proof.stretch import Job
from tests.interfaces.reports.baselines.desk import FIRMWARE

FRAME = "        if self.settings.frame_cost:\n"  # the first line of the service routine after it has read the frame

CASE = """\
name = "small"
duration = "35 ms"

[unit.dsp]
firmware = "firmware.py"
modules = ["I2C-A", "SCI-A", "GPIO"]

[unit.dsp.settings]
order = [0x68]
table = { 0x68 = "11 12 13 14 15 16" }

[controller]
period = "10 ms"
[[controller.request]]
chip = "gyroscope"
expect = "11 12 13 14 15 16"

[host]
baud = 115200
first = "6 ms"
period = "10 ms"

[[budget]]
name = "response"
measure = "response"
max = "60 us"

[[budget]]
name = "wrong bytes"
measure = "wrong bytes"
max = 0
"""
ONLY = Fraction("0.0092375"), Fraction("0.0092377")  # an interrupt comes 1.04 ms after the start of its frame


def put_case(folder: Path, *, service: int = 3000, does: str = "", comment: str = "") -> Path:
    """Write the case and its firmware.

    The service routine computes for `service` more cycles, or executes `does` instead. `comment` is appended to the
    firmware without effect.
    """
    folder.mkdir(exist_ok=True)
    assert FRAME in FIRMWARE
    added = f"        {does or f'self.dsp.compute({service})'}\n"
    (folder / "firmware.py").write_text(FIRMWARE.replace(FRAME, added + FRAME) + comment, encoding="utf-8")
    (folder / "small.toml").write_text(CASE, encoding="utf-8")
    return folder / "small.toml"


def save_coverage(case: Path) -> Path:
    """Run the phases ONLY and write the coverage file, without dependencies on modules of the tests."""
    found = choose(Job(str(case.absolute()), rounds=3), 1, ONLY)
    files = {file: digest for file, digest in found.depends.files.items() if not file.startswith("..")}
    found.depends = replace(found.depends, files=files)
    run_coverage(found, 1, None, coverage_path(case))
    return coverage_path(case)


def put_covered(folder: Path) -> None:
    """Write the case, its baseline and its coverage file to `cases` in a folder."""
    with chdir(folder):
        save_coverage(put_case(Path("cases")))
        check(["cases"], jobs=1, update=True)


def change_coverage(case: Path, **keys: Any) -> None:
    """Change keys of the coverage file of a case."""
    tree = json.loads(coverage_path(case).read_text(encoding="utf-8"))
    coverage_path(case).write_text(json.dumps(tree | keys), encoding="utf-8")
