"""A small case: a slave with registers, which a controller reads."""

from __future__ import annotations

from pathlib import Path

from tests.outside.sessions import FIRMWARE

CASE = f"""
name = "registers"
duration = "10 ms"

[unit.dsp]
firmware = "{FIRMWARE / "register_slave.py"}"
modules = ["I2C-A"]
settings = {{ registers = "11 22 33 44" }}

[controller]
period = "1 ms"

[[controller.request]]
address = 0x50
pointer = 0
count = 2

[[budget]]
name = "all rounds"
measure = "missed rounds"
max = 0

[[budget]]
name = "work"
measure = "cpu load"
max = "50 %"
"""


def written(folder: Path) -> Path:
    path = folder / "registers.toml"
    path.write_text(CASE)
    return path
