"""Small cases for check: the emulator of timing/imu_hil_published.toml with one requested chip, 22 ms long."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[4]
FIRMWARE = (ROOT / "firmware" / "python" / "imu_hil.py").read_text(encoding="utf-8")
WRITE = "        buffer = endless(data)\n"  # the line before the first write of I2CDXR
RUNS = "Emulator(dsp, settings).run()"

CASE = """\
name = "{name}"
duration = "22 ms"

[unit.dsp]
firmware = "{firmware}"
modules = ["I2C-A", "GPIO"]

[unit.dsp.settings]
order = [0x68]
sdir_wait = {sdir_wait}
table = {{ 0x68 = "11 12 13 14 15 16" }}

[controller]
period = "10 ms"
[[controller.request]]
chip = "gyroscope"
expect = "11 12 13 14 15 16"

[[budget]]
name = "response"
measure = "response"
max = "60 us"

[[budget]]
name = "wrong bytes"
measure = "wrong bytes"
max = 0

[[budget]]
name = "model"
measure = "span:model"
max = "300 us"
"""


def put(
    folder: Path, name: str = "small", *, wait: int = 0, sdir_wait: bool = True, breaks: str = "", does: str = RUNS
) -> Path:
    """Write a case file and its firmware to `folder`.

    The firmware computes for `wait` cycles before it writes I2CDXR, and main executes `does`. `breaks` is the line with
    that key.
    """
    folder.mkdir(exist_ok=True)
    assert WRITE in FIRMWARE and RUNS in FIRMWARE
    firmware = folder / f"{name}_firmware.py"
    text = FIRMWARE.replace(WRITE, f"        dsp.compute({wait})\n{WRITE}").replace(RUNS, does)
    firmware.write_text(text, encoding="utf-8")
    text = CASE.format(name=name, firmware=firmware.name, sdir_wait=str(sdir_wait).lower())
    path = folder / f"{name}.toml"
    path.write_text(breaks + text, encoding="utf-8")
    return path


def change(path: Path, **figures: Any) -> None:
    """Change figures of the budget "response" in a baseline file."""
    tree = json.loads(path.read_text(encoding="utf-8"))
    tree["budgets"]["response"] |= figures
    path.write_text(json.dumps(tree), encoding="utf-8")
