"""`make bench`: how fast the sensor-head scene runs here, beside what else one might use. Nothing is asserted on time.

python -m tests.bench.speed [--long]

Everything runs on one core, one after the other. Machines are shared: where the processor's
time is far below the time on the wall, other work took the rest; read the cpu column then.
"""

from __future__ import annotations

import argparse
import os
import platform
from collections.abc import Iterator

from . import memory, peers, scenes
from .timed import Seconds, middle

Row = tuple[str, str, str, str]  # what, figure, wall, cpu
MIB = 1 << 20
SHORT_RUN = ["run", str(scenes.CASE.with_name("imu_hil.toml")), "--duration", "20 ms"]


def speed_rows() -> Iterator[Row]:
    often = scenes.speed()
    result, time = often.result, often.time
    yield "10 s of scene, 20 ms rounds: median of 5", f"{often.rounds} rounds", *shown(time)
    yield from (
        figure(
            "I2C bytes", f"{often.bytes_per_second:,.0f} /s of wall", f"{result.wire_bytes / time.cpu:,.0f} /s of cpu"
        ),
        figure("events", f"{result.events / time.wall:,.0f} /s of wall", f"{result.events / time.cpu:,.0f} /s of cpu"),
        figure("events per I2C byte", f"{result.events / result.wire_bytes:.1f}"),
    )
    each = Seconds(time.wall / often.rounds, time.cpu / often.rounds)
    yield "one round", f"{often.events_per_round:.1f} events", *shown(each)
    each = Seconds(time.wall / result.simulated_s, time.cpu / result.simulated_s)
    yield "one simulated second", f"{result.events / result.simulated_s:,.0f} events", *shown(each)
    rare = scenes.seldom()
    yield "40 s of scene, 2 s rounds", f"{rare.rounds} rounds", *shown(rare.time)
    ratio = rare.events_per_round / often.events_per_round
    yield figure("events per round", f"{rare.events_per_round:.1f}: {ratio:.3f} of the 20 ms case's")


def recording_rows() -> Iterator[Row]:
    plain = scenes.recorded(None)[1]
    yield "1 s of scene, built and run, not recorded", "", *shown(plain)
    for suffix in (".vcd", ".jsonl"):
        size, time = scenes.recorded(suffix)
        extra = f"{time.wall / plain.wall:.2f} times as long, {size / MIB:.1f} MiB"
        yield f"the same, recorded as {suffix}", extra, *shown(time)


def start_rows() -> Iterator[Row]:
    """A command from the shell to its end, process start and imports included."""
    for what, words in (("periph-sim --version", ["--version"]), ("periph-sim run, 20 ms of imu_hil", SHORT_RUN)):
        times = [scenes.command(words) for _ in range(scenes.REPEATS)]
        yield what, "", *shown(middle(times))


def peer_rows() -> Iterator[Row]:
    heap = peers.heap()
    yield "heapq push and pop alone", f"{heap.per_second:,.0f} events/s", *shown(heap.time)
    simpy = peers.simpy_timeouts()
    if isinstance(simpy, str):
        yield figure("SimPy timeouts", simpy)
    else:
        yield "SimPy timeouts", f"{simpy.per_second:,.0f} events/s", *shown(simpy.time)
    bus = peers.cocotb_i2c()
    name = "cocotb + Icarus + cocotbext-i2c, 100 kHz"
    if isinstance(bus, str):
        yield figure(name, bus)
    else:
        yield name, f"{bus.per_second:,.0f} I2C bytes/s", *shown(bus.time)


def memory_rows(long: bool) -> Iterator[Row]:
    if not memory.STATM.exists():
        yield figure("resident set", f"not measured: there is no {memory.STATM} here")
        return
    points = (60, 600) if long else (60, 120)
    sizes = memory.in_a_child(points)
    for point, size in sizes.items():
        yield figure(f"resident set after {point // 60} simulated min", f"{size / MIB:.1f} MiB")
    first, last = sizes.values()
    yield figure("growth between the two", f"{(last - first) / 1024:,.0f} KiB")


def figure(what: str, *figures: str) -> Row:
    """A row without times."""
    return what, ", ".join(figures), "", ""


def shown(time: Seconds) -> tuple[str, str]:
    return seconds(time.wall), seconds(time.cpu)


def seconds(length: float) -> str:
    return f"{length:.2f} s" if length >= 1 else f"{length * 1e3:.2f} ms"


def table(rows: list[Row]) -> str:
    """Markdown, its columns aligned."""
    lines: list[Row] = [("what", "figure", "wall", "cpu"), *rows]
    widths = [max(len(line[column]) for line in lines) for column in range(4)]
    cells = [[cell.ljust(width) for cell, width in zip(line, widths, strict=True)] for line in lines]
    cells.insert(1, ["-" * width for width in widths])
    return "\n".join(f"| {' | '.join(line)} |" for line in cells)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.bench.speed", description="How fast it runs here.")
    parser.add_argument("--long", action="store_true", help="memory after 1 and 10 simulated minutes, not 1 and 2")
    long = parser.parse_args().long
    rows: list[Row] = []
    for part in (speed_rows(), recording_rows(), start_rows(), peer_rows(), memory_rows(long)):
        for row in part:
            print("  ".join(cell for cell in row if cell), flush=True)
            rows.append(row)
    print(
        f"\n{platform.python_implementation()} {platform.python_version()}, {platform.machine()}, "
        f"{os.cpu_count()} cores\n\n{table(rows)}"
    )


if __name__ == "__main__":
    main()
