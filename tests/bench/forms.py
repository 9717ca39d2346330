"""I2C bytes per second of CPU time of the cases that the core is measured by, in the form that is imported.

The speed is that behind the first 100 ms of the scene, which are its start (see `levels`), and told apart from it.

python -m tests.bench.forms [--seconds 2] [--repeat 3] [NAME ...]
"""

from __future__ import annotations

import argparse
from fractions import Fraction
from pathlib import Path

from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene

from .levels import START
from .timed import timed

TIMING = Path(__file__).parents[2] / "timing"
BYTES = tuple(f"unit.dsp.settings.{key}" for key in ("arithmetic=bytes", "model_cost=250 us", "beyond_estimate=0 us"))
CASES = {
    "imu_hil": ("imu_hil", ()),
    "imu_hil bytes": ("imu_hil", BYTES),
    "imu_hil bytes, no budget": ("imu_hil", BYTES),
    "responder": ("responder", ()),
    "two_dsps": ("two_dsps", ()),
}


def bytes_per_cpu_second(name: str, seconds: Fraction) -> tuple[float, float, float]:
    """I2C bytes, and events, per CPU second of one run behind its start, and CPU seconds of that; building is not
    timed."""
    file, changes = CASES[name]
    case = load(TIMING / f"{file}.toml", list(changes))
    if name.endswith("no budget"):
        case = case.model_copy(update={"budget": ()})
    scene = Scene(case)
    _, start = timed(lambda: scene.advance(scene.start + scene.timebase.ticks(START, "nearest")))
    wire_bytes, events = scene.bytes_on_bus(), scene.kernel.events
    result, time = timed(lambda: scene.run(seconds))
    return (result.wire_bytes - wire_bytes) / time.cpu, (result.events - events) / time.cpu, start.cpu


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", default="2")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("names", nargs="*")
    given = parser.parse_args()
    for name in given.names or CASES:
        runs = [bytes_per_cpu_second(name, Fraction(given.seconds)) for _ in range(given.repeat)]
        best = max(runs)
        start = min(one[2] for one in runs) * 1e3
        print(f"{name:28} {best[0]:10,.0f} bytes/s {best[1]:12,.0f} events/s {start:8.2f} ms start", flush=True)


if __name__ == "__main__":
    main()
