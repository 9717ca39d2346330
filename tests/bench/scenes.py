"""The plain sensor-head scene (timing/imu_hil_published.toml) run in this process: its speed, and what recording costs.

load -> Scene (not timed) -> run (timed) -> Measured
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from time import perf_counter

from periph_sim.records.if_recorded import if_recorded
from periph_sim.scene.case.load import load
from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene

from .timed import Seconds, median_of, middle, timed

CASE = Path(__file__).parents[2] / "timing" / "imu_hil_published.toml"
REPEATS = 5


@dataclass(frozen=True)
class Measured:
    """What a run did, and the median time that it took."""

    result: Result
    time: Seconds

    @property
    def rounds(self) -> int:
        return self.result.counts["rounds"]

    @property
    def bytes_per_second(self) -> float:
        return self.result.wire_bytes / self.time.wall

    @property
    def events_per_round(self) -> float:
        return self.result.events / self.rounds


def run_scene(seconds: int, changes: list[str] | None = None) -> tuple[Result, Seconds]:
    """One run of a scene that is built anew; building is not timed."""
    scene = Scene(load(CASE, changes))
    return timed(lambda: scene.run(Fraction(seconds)))


def speed(seconds: int = 10) -> Measured:
    """The case as it is, nothing recorded: the median of five runs after one that warms up."""
    run_scene(1)
    runs = [run_scene(seconds) for _ in range(REPEATS)]
    return Measured(runs[-1][0], middle([time for _, time in runs]))


def command(words: list[str]) -> Seconds:
    """A command line of ours in a process of its own."""
    before, wall = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    subprocess.run([sys.executable, "-m", "periph_sim", *words], capture_output=True, check=False)
    after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter() - wall
    return Seconds(wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def seldom(rounds: int = 20) -> Measured:
    """The same rounds, but 2 s apart instead of 20 ms: nearly all of the time nothing happens."""
    return Measured(*run_scene(2 * rounds, ["controller.period=2 s", "host.period=2 s"]))


def recorded(suffix: str | None, seconds: int = 1) -> tuple[int, Seconds]:
    """Bytes written, and the median time of a scene that is recorded from its building to the closed file."""
    with tempfile.TemporaryDirectory() as folder:
        path = None if suffix is None else Path(folder) / f"bench{suffix}"
        case = load(CASE)

        def run() -> None:
            with if_recorded(path, case.recorded_modules) as (subscribe, ended_at):
                scene = Scene(case, subscribe)
                scene.run(Fraction(seconds))
                ended_at(scene.kernel.now)

        _, time = median_of(REPEATS, run)
        return (0 if path is None else path.stat().st_size), time
