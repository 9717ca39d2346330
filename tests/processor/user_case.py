"""Write a case with a user's own firmware and I2C device to a folder."""

from __future__ import annotations

from pathlib import Path

CASE = """\
name = "{name}"
{keys}

[unit.dsp]
firmware = "{name}.py"
modules = ["I2C-A", "TIMER0", "SCI-A"]

[device.mine]
model = "mine.py"
address = 0x42

[controller]
order = []
first = "1 ms"
period = "5 ms"

[[controller.request]]
name = "both"
address = 0x42
write = "01"
count = 1

[[budget]]
name = "rounds"
measure = "missed rounds"
max = 0

[[budget]]
name = "round"
measure = "round"
max = "5 ms"
"""


def write_case(folder: Path, name: str, firmware: str, device: str, keys: str) -> Path:
    """Write NAME.toml with these further keys, NAME.py and mine.py; the case writes and reads one byte every 5 ms."""
    for file, text in ((f"{name}.py", firmware), ("mine.py", device)):
        (folder / file).write_text(text, encoding="utf-8")
    path = folder / f"{name}.toml"
    path.write_text(CASE.format(name=name, keys=keys), encoding="utf-8")
    return path
