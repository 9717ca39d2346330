"""A scene that holds long chains of objects is released in a thread whose stack is small."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

DEVICE = """
class Device:
    def __init__(self, bus):
        self.bus = bus

    def on_write(self, byte):
        for _ in range(10_000):
            self.bus.after("1 s", self.later)
        return True

    def later(self): ...
"""
CASE = """
name = "chain"
duration = "60 ms"

[device.mine]
model = "mine.py"
address = 0x42

[controller]
first = "1 ms"
period = "{period}"
rate = "400 kHz"

[[controller.request]]
name = "mine"
address = 0x42
count = 0
write = "{written}"

[[budget]]
name = "until the end"
measure = "from edge SCL fall to bus NACK"
max = "1 s"
"""
RELEASE = """
import sys, threading
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene

scene = Scene(load(sys.argv[1]))
result = scene.run()
print(result.verdict, result.events, flush=True)
held = [scene]
del scene, result
threading.stack_size(256 * 1024)
thread = threading.Thread(target=held.clear)
thread.start()
thread.join()
print("released")
"""


@pytest.mark.parametrize(
    ("device", "period", "written"),
    [
        (DEVICE, "30 ms", "01"),
        (DEVICE.replace("10_000", "0"), "1 ms", " ".join(["01"] * 20)),
    ],
    ids=["20 000 calls that are due after the end", "10 000 edges that nothing ends"],
)
def test_a_scene_is_released_without_recursion(tmp_path: Path, device: str, period: str, written: str):
    (tmp_path / "mine.py").write_text(device, "utf-8")
    (tmp_path / "case.toml").write_text(CASE.format(period=period, written=written), "utf-8")
    done = subprocess.run(
        [sys.executable, "-c", RELEASE, str(tmp_path / "case.toml")], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout.splitlines()[-1:], done.stderr) == (0, ["released"], "")
