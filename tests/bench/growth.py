"""How a run's cost grows: with the devices on the bus, and with the length of the run.

python -m tests.bench.growth [--long]

    N EEPROMs on one bus, of which one is asked --> CPU seconds a simulated second, events a byte, memory
    imu_hil for 1 s, 10 s, 60 s (--long: 600 s, 3600 s) --> the same
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from time import process_time

from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from periph_sim.scene.scene import Scene

TIMING = Path(__file__).parents[2] / "timing"
DEVICES = (1, 10, 60)  # a wire has up to 62 parties
LENGTHS = ("1", "10", "60")
LONG = (*LENGTHS, "600", "3600")
FIRST = 0x08  # of the addresses that are free for devices


def with_devices(number: int) -> Case:
    """A controller and so many register devices, of which it asks the first."""
    devices = {f"d{n}": {"model": "registers", "address": FIRST + n, "register": REGISTERS} for n in range(number)}
    asks = {"period": "5 ms", "request": [{"address": FIRST, "pointer": 0, "count": 8}]}
    return Case.model_validate({"name": "growth", "unit": {}, "device": devices, "controller": asks, "duration": "1 s"})


REGISTERS = [{"name": "DATA", "at": 0, "reset": 0x5A}]


def measured(case: Case, seconds: str) -> dict[str, float]:
    scene = Scene(case)
    began = process_time()
    result = scene.run(Fraction(seconds))
    cpu = process_time() - began
    return {
        "cpu_s_per_s": cpu / float(Fraction(seconds)),
        "events_per_byte": result.events / result.wire_bytes,
        "memory_mib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.bench.growth", description="How cost grows.")
    parser.add_argument("--long", action="store_true", help="runs of 10 minutes and an hour, too")
    parser.add_argument("--one", nargs=2, metavar=("KIND", "VALUE"), help="one point, of this very process")
    given = parser.parse_args()
    if given.one:
        kind, value = given.one
        case = with_devices(int(value)) if kind == "devices" else load(TIMING / "imu_hil.toml")
        print(json.dumps(measured(case, "1" if kind == "devices" else value)))
        return
    for kind, values in (("devices", map(str, DEVICES)), ("seconds", LONG if given.long else LENGTHS)):
        for value in values:
            command = [sys.executable, "-m", "tests.bench.growth", "--one", kind, value]
            found = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
            figures = ", ".join(f"{name} {figure:,.4g}" for name, figure in found.items())
            print(f"{value:>5} {kind:8} {figures}", flush=True)


if __name__ == "__main__":
    main()
