"""Every shipped case in both forms, with and without skipped bits: I2C bytes per second of CPU time, events, memory.

    case, form --> a process of its own: load, build, run at each level in turn, repeatedly --> rows of medians

The levels take turns, so that other work on the machine slows all of them. The first run at each level is short and
is not counted, because it imports modules. The first 100 ms of each other run count as its start, apart from the speed
after it: in this time firmware sets up its modules, models are sampled, and each wait, byte and record occurs for the
first time. All runs of a case must carry the same bytes, so that a stuck run cannot count as fast.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any, NamedTuple

from periph_sim import form
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene

from .child import TIMING, in_form
from .timed import peak_mib, timed

Row = dict[str, Any]

EXACT, PLAIN = "exact", "edge by edge"  # without skipped polls a run would take minutes, so both skip them
LEVELS: dict[str, tuple[str, ...]] = {EXACT: (), PLAIN: ("disable=bits",)}
BYTES = tuple(f"unit.dsp.settings.{key}" for key in ("arithmetic=bytes", "model_cost=250 us", "beyond_estimate=0 us"))
VARIANTS: dict[str, tuple[str, tuple[str, ...]]] = {  # shipped cases with changes
    "imu_hil, arithmetic = bytes": ("imu_hil", BYTES),
    "imu_hil, arithmetic = bytes, no budgets": ("imu_hil", (*BYTES, "budget=[]")),
    "responder, waits declared": ("responder", ("unit.dsp.firmware=responder_declared",)),
}
SECONDS = {form.COMPILED: "4", form.INTERPRETED: "0.25"}  # of scene; figures are per byte and per second of scene
POLLED = ("imu_hil_c",)  # C sources: every poll is executed, so a simulated second takes a minute
WARM = Fraction(1, 50)
START = Fraction(1, 10)


class Run(NamedTuple):
    """CPU seconds of set-up, of the start, and of the time after it, and the counts of that time."""

    build: float
    start: float
    cpu: float
    wire_bytes: int
    events: int
    skipped: int
    simulated: float


def cases() -> dict[str, tuple[str, tuple[str, ...]]]:
    """Return file and changes of each case by its name."""
    names = sorted(path.stem for path in TIMING.glob("*.toml") if path.stem not in POLLED)
    return {name: (name, ()) for name in names} | VARIANTS


def rows(forms: Sequence[str], repeat: int) -> Iterator[Row]:
    for name, (file, changes) in cases().items():
        for which in forms:
            yield from in_form(which, "levels", "measured", name, file, changes, SECONDS[which], repeat)


def measured(name: str, file: str, changes: Sequence[str], seconds: str, repeat: int) -> list[Row]:
    """Return the rows of a case, run in this process. Raise AssertionError if its runs did not carry the same bytes."""
    found: list[Row] = []
    path = TIMING / f"{file}.toml"
    runs: dict[str, list[Run]] = {}
    for level, off in LEVELS.items():
        run(path, [*changes, *off], WARM)
        runs[level] = []
    for _ in range(repeat):
        for level, done in runs.items():
            done.append(run(path, [*changes, *LEVELS[level]], Fraction(seconds)))
    carried = {one.wire_bytes for done in runs.values() for one in done}
    if len(carried) > 1:
        raise AssertionError(f"{name}: runs of the same case carried {sorted(carried)} bytes, so one was stuck")
    memory = peak_mib()
    for level, done in runs.items():
        cpu, one = median(each.cpu for each in done), done[0]
        per_byte = 1 / one.wire_bytes if one.wire_bytes else 0.0
        found.append(
            {
                "case": name,
                "form": form.running,
                "level": level,
                "bytes_per_s": one.wire_bytes / cpu,
                "cpu_s_per_s": cpu / one.simulated,
                "build_s": median(each.build for each in done),
                "start_s": median(each.start for each in done),
                "events_per_byte": one.events * per_byte,
                "skipped_percent": 100 * one.skipped * per_byte,
                "process_mib": memory,  # of the process that ran all levels
            }
        )
    return found


def run(path: Path, changes: Sequence[str], seconds: Fraction) -> Run:
    """Run `seconds` of a case, and return the figures after its start."""
    began = process_time()
    scene = Scene(load(path, list(changes)))
    build = process_time() - began
    first = scene.start + scene.timebase.ticks(START, "nearest")
    start = timed(lambda: scene.advance(first))[1].cpu
    wire_bytes, events, skipped = scene.bytes_on_bus(), scene.kernel.events, scene.bus.passed
    result, time = timed(lambda: scene.run(seconds))
    return Run(
        build,
        start,
        time.cpu,
        result.wire_bytes - wire_bytes,
        result.events - events,
        result.bytes_skipped - skipped,
        result.simulated_s,
    )


def line(row: Row) -> str:
    head = f"{row['case']:28} {row['form']:12} {row['level']:21}"
    return (
        f"{head} {row['bytes_per_s']:10,.0f} bytes/s {row['cpu_s_per_s']:8.4f} s/s {row['build_s'] * 1e3:7.2f} ms "
        f"set-up {row['start_s'] * 1e3:7.2f} ms start "
        f"{row['events_per_byte']:6.1f} events/byte {row['skipped_percent']:5.1f} % with skipped bits"
    )


def plot(found: Sequence[Row], path: Path) -> None:
    """Draw bars of bytes per second on a logarithmic axis: a group per case, a bar per form and level."""
    import matplotlib

    matplotlib.use("svg")
    from matplotlib import pyplot

    shown = [row for row in found if row.get("bytes_per_s")]
    names = list(dict.fromkeys(row["case"] for row in shown))
    kinds = sorted({(row["form"], row["level"]) for row in shown})
    figure, axes = pyplot.subplots(figsize=(10, 0.5 + 0.6 * len(names)))
    height = 0.8 / len(kinds)
    for place, kind in enumerate(kinds):
        of = {row["case"]: row["bytes_per_s"] for row in shown if (row["form"], row["level"]) == kind}
        at = [names.index(name) + place * height for name in of]
        axes.barh(at, list(of.values()), height, label=f"{kind[1]}, {kind[0]}")
    axes.set_xscale("log")
    axes.set_xlabel("I2C bytes per second of CPU time")
    axes.set_yticks([n + 0.4 - height / 2 for n in range(len(names))], names)
    axes.invert_yaxis()
    axes.legend(fontsize="small")
    figure.tight_layout()
    figure.savefig(path)
