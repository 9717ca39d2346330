"""Does a long run grow? A fresh process runs the scene and tells its resident set at two points of simulated time.

python -m tests.bench.memory 60 120  ->  one JSON object: {"60": bytes, "120": bytes}
"""

from __future__ import annotations

import gc
import json
import os
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene

from .scenes import CASE

ROOT = Path(__file__).parents[2]
STATM = Path("/proc/self/statm")


def in_a_child(points: tuple[int, int]) -> dict[int, int]:
    """Resident bytes at each point (simulated seconds), from a process that does nothing else."""
    command = [sys.executable, "-m", "tests.bench.memory", *map(str, points)]
    told = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return {int(point): size for point, size in json.loads(told).items()}


def resident() -> int:
    """Bytes of this process that are in memory now; rubbish is not counted."""
    gc.collect()
    pages = int(STATM.read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def main(points: list[int]) -> None:
    scene = Scene(load(CASE))
    sizes: dict[int, int] = {}
    at = 0
    for point in points:
        scene.run(Fraction(point - at))
        at = point
        sizes[point] = resident()
    print(json.dumps(sizes))


if __name__ == "__main__":
    main([int(argument) for argument in sys.argv[1:]])
