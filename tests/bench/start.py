"""Cost of short runs: commands from the shell to their end, and 10 ms of imu_hil from Python with set-up.

periph-sim ... --> a separate process, with imports --> median CPU and wall seconds
Scene(load(imu_hil)).run(10 ms), repeated in one process --> the same, except of the first
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

from periph_sim import form
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene

from .child import ROOT, TIMING, environment, in_form
from .timed import Seconds, middle, spent, timed

Row = dict[str, Any]

COMMANDS = {
    "periph-sim --version": ["--version"],
    "periph-sim run, 20 ms of imu_hil": ["run", str(TIMING / "imu_hil.toml"), "--seconds", "0.02"],
    "periph-sim run, 20 ms of responder": ["run", str(TIMING / "responder.toml"), "--seconds", "0.02"],
}
SHORT = "10 ms of imu_hil from Python, set-up included"
TIMES = 30


def rows(forms: Sequence[str], repeat: int) -> Iterator[Row]:
    for what, words in COMMANDS.items():
        runs: dict[str, list[Seconds]] = {which: [] for which in forms}
        command(words, forms[0])  # the very first command reads its files from the disk
        for _ in range(repeat):
            for which in forms:
                runs[which].append(command(words, which))
        for which in forms:
            yield row(what, which, middle(runs[which]))
    for which in forms:
        yield in_form(which, "start", "short")


def command(words: Sequence[str], which: str) -> Seconds:
    return spent([sys.executable, "-m", "periph_sim", *words], cwd=ROOT, env=environment(which))


def short() -> Row:
    """Measure runs in this process, in its form of the core."""
    times = [timed(build_and_run)[1] for _ in range(TIMES + 1)]
    return row(SHORT, form.running, middle(times[1:])) | {"first_cpu_s": times[0].cpu}


def build_and_run() -> None:
    Scene(load(TIMING / "imu_hil.toml")).run(Fraction(1, 100))


def row(what: str, which: str, time: Seconds) -> Row:
    return {"what": what, "form": which, "cpu_s": time.cpu, "wall_s": time.wall}


def line(row: Row) -> str:
    return (
        f"{row['what']:46} {row['form']:12} {row['cpu_s'] * 1e3:8.2f} ms of cpu {row['wall_s'] * 1e3:8.2f} ms of wall"
    )
