"""Every shipped case in both forms and at each level: I2C bytes per second of CPU time, events and memory.

python -m tests.bench.levels [--seconds 1] [--repeat 3] [--json FILE] [--plot FILE] [CASE ...]

    case, form, level --> a process of its own: load, build (not timed), run (CPU time) --> Point --> table, JSON, plot

A level that a case refuses is named with the reason. A form that is not built is left out, which is said. Medians; the
forms of one level come one after the other, so that a busy machine slows both.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from fractions import Fraction
from pathlib import Path
from time import process_time

from periph_sim import form
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from periph_sim.scene.scene import Scene

TIMING = Path(__file__).parents[2] / "timing"
FORMS = (form.INTERPRETED, form.COMPILED)
LEVELS = ("edge", "adaptive", "byte")
VARIANTS = {"responder_declared": ("responder", "unit.dsp.firmware=responder_declared")}  # shipped cases, changed


@dataclass(frozen=True)
class Point:
    """One case in one form at one level. cpu: seconds per simulated second. refused: why there is nothing."""

    case: str
    form: str
    level: str
    bytes_per_s: float = 0.0
    cpu: float = 0.0
    build: float = 0.0  # CPU seconds of load and build, imports apart
    events_per_byte: float = 0.0
    byte_level: float = 0.0  # per cent of the I2C bytes
    memory_mib: float = 0.0
    refused: str = ""


def one(name: str, level: str, seconds: str) -> Point:
    """In this process, in the form that it has."""
    began = process_time()
    try:
        file, *changes = VARIANTS.get(name, (name,))
        scene = Scene(load(TIMING / f"{file}.toml", [f"fidelity={level}", *changes]))
    except BadCase as refused:
        return Point(name, form.running, level, refused=str(refused).partition("cannot be: ")[2].partition(";")[0])
    build = process_time() - began
    began = process_time()
    result = scene.run(Fraction(seconds))
    cpu = process_time() - began
    passed = result.counts.get("byte_level", 0)
    per_byte = 1 / result.wire_bytes if result.wire_bytes else 0.0
    return Point(
        name,
        form.running,
        level,
        bytes_per_s=result.wire_bytes / cpu,
        cpu=cpu / result.simulated_s,
        build=build,
        events_per_byte=result.events * per_byte,
        byte_level=100 * passed * per_byte,
        memory_mib=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    )


def in_a_child(name: str, which: str, level: str, seconds: str) -> Point:
    """The same in a process of its own, in the form that is asked for."""
    command = [sys.executable, "-m", "tests.bench.levels", "--one", name, level, "--seconds", seconds]
    environment = {**os.environ, form.VARIABLE: which}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return Point(**json.loads(done.stdout.splitlines()[-1]))


def points(names: Sequence[str], forms: Sequence[str], seconds: str, repeat: int) -> Iterator[Point]:
    """The median run of each, by its CPU time."""
    for name in names:
        for level in LEVELS:
            runs: dict[str, list[Point]] = {which: [] for which in forms}
            for _ in range(repeat):
                for which in forms:
                    runs[which].append(in_a_child(name, which, level, seconds))
            for which in forms:
                middle = statistics.median_low(point.cpu for point in runs[which])
                yield next(point for point in runs[which] if point.cpu == middle)


def line(point: Point) -> str:
    if point.refused:
        return f"{point.case:22} {point.level:9} {point.form:12} refused: {point.refused}"
    return (
        f"{point.case:22} {point.level:9} {point.form:12} {point.bytes_per_s:9,.0f} bytes/s {point.cpu:8.4f} s/s "
        f"{point.events_per_byte:6.1f} events/byte {point.byte_level:5.1f} % {point.memory_mib:5.0f} MiB"
    )


def plot(found: Sequence[Point], path: Path) -> None:
    """Bars of bytes per second, logarithmic: a group a case, a bar a form and level."""
    import matplotlib

    matplotlib.use("svg")
    from matplotlib import pyplot

    shown = [point for point in found if point.bytes_per_s]
    names = list(dict.fromkeys(point.case for point in shown))
    kinds = list(dict.fromkeys((point.form, point.level) for point in shown))
    figure, axes = pyplot.subplots(figsize=(10, 0.5 + 0.45 * len(names)))
    height = 0.8 / len(kinds)
    for place, kind in enumerate(kinds):
        of = {point.case: point.bytes_per_s for point in shown if (point.form, point.level) == kind}
        at = [names.index(name) + place * height for name in of]
        axes.barh(at, list(of.values()), height, label=f"{kind[1]}, {kind[0]}")
    axes.set_xscale("log")
    axes.set_xlabel("I2C bytes per second of CPU time")
    axes.set_yticks([n + 0.4 - height / 2 for n in range(len(names))], names)
    axes.invert_yaxis()
    axes.legend(fontsize="small")
    figure.tight_layout()
    figure.savefig(path)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.bench.levels", description="Each case, form and level.")
    parser.add_argument("--seconds", default="1")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--plot", type=Path)
    parser.add_argument("--one", nargs=2, metavar=("CASE", "LEVEL"), help="print one point of this very process")
    parser.add_argument("cases", nargs="*")
    given = parser.parse_args()
    if given.one:
        print(json.dumps(asdict(one(*given.one, given.seconds))))
        return
    forms = FORMS if form.running == form.COMPILED else FORMS[:1]
    if len(forms) == 1:
        print(f"interpreted only: {form.note or 'the core is not compiled; `make core` does'}")
    names = given.cases or sorted([*(path.stem for path in TIMING.glob("*.toml")), *VARIANTS])
    found: list[Point] = []
    for point in points(names, forms, given.seconds, given.repeat):
        print(line(point), flush=True)
        found.append(point)
    if given.json:
        given.json.parent.mkdir(parents=True, exist_ok=True)
        given.json.write_text(json.dumps([asdict(point) for point in found], indent=1) + "\n", "utf-8")
    if given.plot:
        plot(found, given.plot)


if __name__ == "__main__":
    main()
