"""Cost of recording: a run without recording, a run whose flags are kept, and a run for each kind of recording file.

imu_hil, form --> a process of its own: build, run, close the file; all in turn --> medians, ratios
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from fractions import Fraction
from pathlib import Path
from statistics import median
from typing import Any

from periph_sim import form
from periph_sim.core.records import Kind, Recorder
from periph_sim.core.time import Timebase
from periph_sim.records.recording import recording
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from periph_sim.traces.formats.record_table import Columns

from .child import TIMING, in_form
from .levels import SECONDS
from .timed import timed

Row = dict[str, Any]

NOTHING, FLAGS = "nothing", "flags, kept"
WAYS = (NOTHING, FLAGS, ".psr", ".vcd", ".jsonl")
CASES = ("imu_hil", "imu_hil_published", "responder")


def rows(forms: Sequence[str], repeat: int) -> Iterator[Row]:
    for name in CASES:
        for which in forms:
            yield from in_form(which, "recorded", "measured", name, SECONDS[which], repeat)


def measured(name: str, seconds: str, repeat: int) -> list[Row]:
    """Measure a case in this process, in its form of the core."""
    with tempfile.TemporaryDirectory() as folder:
        runs: dict[str, list[tuple[float, int]]] = {way: [] for way in WAYS}
        for way in WAYS:
            run(name, way, Fraction(1, 50), Path(folder))
        for _ in range(repeat):
            for way in WAYS:
                runs[way].append(run(name, way, Fraction(seconds), Path(folder)))
    plain = median(cpu for cpu, _ in runs[NOTHING])
    return [
        {
            "case": name,
            "form": form.running,
            "recorded": way,
            "cpu_s_per_s": median(cpu for cpu, _ in runs[way]) / float(Fraction(seconds)),
            "times_as_long": median(cpu for cpu, _ in runs[way]) / plain,
            "mib_per_s": runs[way][0][1] / float(Fraction(seconds)) / (1 << 20),
        }
        for way in WAYS
    ]


def run(name: str, way: str, seconds: Fraction, folder: Path) -> tuple[float, int]:
    """Return the CPU seconds of the run and of closing its file, and the size of the file."""
    case = load(TIMING / f"{name}.toml")
    path = folder / f"run{way}" if way.startswith(".") else None
    with recording(path, case.recorded_modules) as (subscribe, ended_at):
        scene = Scene(case, _keep_flags if way == FLAGS else subscribe)

        def run_and_close() -> None:
            scene.run(seconds)
            ended_at(scene.kernel.now, {})

        time = timed(run_and_close)[1]
    return time.cpu, 0 if path is None else path.stat().st_size


def _keep_flags(recorder: Recorder, timebase: Timebase) -> None:
    recorder.subscribe([Kind.FLAG], Columns())


def line(row: Row) -> str:
    return (
        f"{row['case']:18} {row['form']:12} recorded: {row['recorded']:12} {row['cpu_s_per_s']:8.4f} s/s, "
        f"{row['times_as_long']:.2f} times as long, {row['mib_per_s']:.2f} MiB per simulated second"
    )
