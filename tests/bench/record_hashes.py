"""Hashes of the records of every shipped case, one line per case. Equal lines mean equal records, events, assumptions.

python -m tests.bench.record_hashes [--seconds 2] [CASE ...]

    case, seconds --> run, recorded as .jsonl --> name, SHA-256 of the recording, events, SHA-256 of the result
"""

from __future__ import annotations

import argparse
import gc
import hashlib
import json
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from fractions import Fraction
from pathlib import Path

from periph_sim.records.recording import recording
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from periph_sim.scene.scene import Scene

TIMING = Path(__file__).parents[2] / "timing"


def line_of(name: str, seconds: str) -> str:
    """Run and record one case."""
    return recorded(name, load(TIMING / f"{name}.toml"), seconds)


def recorded(name: str, case: Case, seconds: str) -> str:
    """Run and record a case, and return its line."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.jsonl"
        with recording(path, case.recorded_modules) as (subscribe, ended_at):
            scene = Scene(case, subscribe)
            polled = any(unit.sources for unit in case.unit.values())  # C sources take a minute for a simulated second
            result = scene.run(min(Fraction(seconds), Fraction(case.duration)) if polled else Fraction(seconds))
            ended_at(scene.kernel.now, {})
        records = hashlib.sha256(path.read_bytes()).hexdigest()[:16]
    shown = {key: value for key, value in asdict(result).items() if key not in ("wall_s", "form")}
    figures = hashlib.sha256(json.dumps(shown, sort_keys=True, default=str).encode()).hexdigest()[:16]
    return f"{name} {records} {result.events} {figures}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", default="2")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("cases", nargs="*")
    parser.add_argument("--collect", action="store_true", help="collect garbage at each new object, at one job")
    given = parser.parse_args()
    names = given.cases or sorted(path.stem for path in TIMING.glob("*.toml"))
    seconds = [given.seconds] * len(names)
    if given.collect:
        gc.freeze()
        gc.set_threshold(1)
        for line in map(line_of, names, seconds):
            print(line, flush=True)
        return
    with ProcessPoolExecutor(given.jobs) as pool:
        for line in pool.map(line_of, names, seconds):
            print(line, flush=True)


if __name__ == "__main__":
    main()
