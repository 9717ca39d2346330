"""I2C bytes per second of CPU time of the cases by which the core is measured, in the imported form.

The speed excludes the first 100 ms of the scene, which are its start (see `levels`) and are printed separately.

python -m tests.bench.forms [--seconds 2] [--repeat 3] [NAME ...]
"""

from __future__ import annotations

import argparse
from fractions import Fraction

from .child import TIMING
from .levels import cases, run

NAMES = ("imu_hil", "imu_hil, arithmetic = bytes", "imu_hil, arithmetic = bytes, no budgets", "responder", "two_dsps")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=Fraction, default=Fraction(2))
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("names", nargs="*")
    given = parser.parse_args()
    for name in given.names or NAMES:
        file, changes = cases()[name]
        runs = [run(TIMING / f"{file}.toml", changes, given.seconds) for _ in range(given.repeat)]
        best, start = min(runs, key=lambda one: one.cpu), min(one.start for one in runs) * 1e3
        speed = f"{best.wire_bytes / best.cpu:10,.0f} bytes/s {best.events / best.cpu:12,.0f} events/s"
        print(f"{name:40} {speed} {start:8.2f} ms start", flush=True)


if __name__ == "__main__":
    main()
