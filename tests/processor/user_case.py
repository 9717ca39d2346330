"""A case with firmware and an I2C device of the user's own: texts go in, files in a folder come out."""

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
    """The case NAME.toml with these further keys, NAME.py and mine.py: one byte is written and read every 5 ms."""
    for file, text in ((f"{name}.py", firmware), ("mine.py", device)):
        (folder / file).write_text(text, encoding="utf-8")
    path = folder / f"{name}.toml"
    path.write_text(CASE.format(name=name, keys=keys), encoding="utf-8")
    return path
