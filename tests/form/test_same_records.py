"""Recordings of both forms of the core are identical, byte for byte.

Each shipped case is run, and idle runs of a day and of decades with one round at the end. Each form runs in its own
process. Skipped unless the compiled core is built from these sources (`make core`).
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from periph_sim.form import BUILT, COMPILED, INTERPRETED, PACKAGE, VARIABLE, usable

ROOT = Path(__file__).parents[2]

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not usable(PACKAGE, BUILT)[0], reason="no core compiled of these sources: make core"),
]

IDLE_UNTIL_THE_END = """
import hashlib, sys
from pathlib import Path
from periph_sim import form
from periph_sim.records.recording import recording
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene

folder = Path(sys.argv[1])
print(form.running)
for name in sys.argv[2:]:
    case = load(folder / f"{name}.toml")
    path = folder / f"{name}.{form.running}.jsonl"
    with recording(path, case.recorded_modules) as (subscribe, ended_at):
        scene = Scene(case, subscribe)
        result = scene.run()
        ended_at(scene.kernel.now, {})
    recorded = path.read_bytes()
    print(name, hashlib.sha256(recorded).hexdigest(), result.events, result.wire_bytes, result.verdict)
"""
CASE = """
name = "late"
duration = "{duration}"
[unit.dsp]
firmware = "{firmware}"
modules = ["I2C-A"]
ppm = {ppm}
[controller]
first = "{first}"
period = "1 ms"
[[controller.request]]
name = "r"
address = 0x50
pointer = 0
count = 2
expect = "01 02"
[[budget]]
name = "wrong bytes"
measure = "wrong bytes"
max = 0
"""
DAY, DECADES = ("24 h", "86400.002 s"), ("17790 d", "1537056000.002 s")
LATE = {
    "day_37": (*DAY, "37"),
    "day_slow": (*DAY, "-1000"),
    "decades_37": (*DECADES, "37"),
    "decades_fast": (*DECADES, "1000"),
    "decades_nearly": (*DECADES, "0.001"),
}


def lines_of(form: str, *given: str) -> list[str]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path]), VARIABLE: form}
    done = subprocess.run(
        [sys.executable, *given], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0 and done.stderr == "", done.stderr
    return done.stdout.splitlines()


def test_each_shipped_case_has_the_same_records_in_both_forms() -> None:
    command = ("-m", "tests.bench.record_hashes", "--seconds", "0.03")
    compiled, interpreted = lines_of(COMPILED, *command), lines_of(INTERPRETED, *command)
    assert compiled == interpreted
    assert len(compiled) == len(list(ROOT.glob("timing/*.toml")))


def test_a_round_after_an_idle_day_or_idle_decades_has_the_same_records_in_both_forms(tmp_path: Path) -> None:
    """With a clock error in ppm, the product of cycle and numerator exceeds 64 bits within an hour."""
    for name, (first, duration, ppm) in LATE.items():
        text = CASE.format(firmware=ROOT / "firmware/python/responder.py", first=first, duration=duration, ppm=ppm)
        (tmp_path / f"{name}.toml").write_text(text)
    command = ("-c", IDLE_UNTIL_THE_END, str(tmp_path), *LATE)
    compiled, interpreted = lines_of(COMPILED, *command), lines_of(INTERPRETED, *command)
    assert (compiled[0], interpreted[0]) == (COMPILED, INTERPRETED)
    assert compiled[1:] == interpreted[1:]
    assert [line.split()[0] for line in compiled[1:]] == list(LATE)
    assert {line.split()[-1] for line in compiled[1:]} == {"pass"}, compiled
