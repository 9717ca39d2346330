"""Speed of other tools at similar work, on this machine and at the same time: heapq, SimPy, cocotb with Icarus Verilog.

    events without an action: heapq, our kernel in both forms, SimPy --> events a second of CPU time
    bytes on an I2C bus:    cocotb + Icarus Verilog + cocotbext-i2c --> bytes a second of CPU time, and missing features

A tool that is not installed has a row with the reason, and the others are measured.
"""

from __future__ import annotations

import importlib.util
import json
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from pathlib import Path
from typing import Any

from periph_sim import form
from periph_sim.core.agent import Agent
from periph_sim.core.kernel import Kernel

from .child import in_form
from .timed import Seconds, median_of, middle

Row = dict[str, Any]

REPEATS = 5
PENDING = 8  # pending events at a time, about as many as in the sensor-head scene
GET_THEM = "pip install -e '.[bench]'"

# Open drain: a party that writes 0 pulls, one that writes 1 releases; tri1 is the pull-up.
BUS = """\
`timescale 1ns / 1ns
module bus;
    reg master_sda = 1, master_scl = 1, memory_sda = 1, memory_scl = 1;
    tri1 sda, scl;
    assign sda = master_sda ? 1'bz : 1'b0;
    assign sda = memory_sda ? 1'bz : 1'b0;
    assign scl = master_scl ? 1'bz : 1'b0;
    assign scl = memory_scl ? 1'bz : 1'b0;
endmodule
"""


# Writes take effect at once instead of in the simulator's read-write phase: a third faster, same bytes.
FASTEST = {"COCOTB_TRUST_INERTIAL_WRITES": "1"}


@dataclass(frozen=True)
class Rate:
    """A number of things (events, bytes) and the median time that they took."""

    count: int
    time: Seconds

    @property
    def per_second(self) -> float:
        return self.count / self.time.cpu


BUS_OF_OTHERS = "cocotb + Icarus Verilog + cocotbext-i2c: a master asks a memory"
LACKS = (
    "a master and a memory on two wires, in Python: no registers, flags, FIFOs or interrupts of a chip, no firmware "
    "and no cycles of a CPU, no SCI, no records, no budgets; levels change without noise filters or clocks that are off"
)


def rows(forms: Sequence[str]) -> Iterator[Row]:
    yield row("heapq: push and pop, nothing between", "events", heap())
    for which in forms:
        yield in_form(which, "peers", "own_kernel")
    yield row("SimPy: timeouts", "events", simpy_timeouts())
    yield row(BUS_OF_OTHERS, "I2C bytes", cocotb_i2c()) | {"lacks": LACKS}


def row(what: str, counted: str, found: Rate | str) -> Row:
    if isinstance(found, str):
        return {"what": what, "counted": counted, "skipped": found}
    return {"what": what, "counted": counted, "per_s": found.per_second, "cpu_s": found.time.cpu}


def line(row: Row) -> str:
    head = f"{row['what']:64}"
    if "skipped" in row:
        return f"{head} skipped: {row['skipped']}"
    shown = f"{head} {row['per_s']:12,.0f} {row['counted']}/s"
    return f"{shown}\n  not modelled there: {row['lacks']}" if "lacks" in row else shown


class Waiter(Agent):
    """An agent that only schedules its next event."""

    def __init__(self, kernel: Kernel) -> None:
        self.kernel = kernel

    def act(self, tag: int) -> None:
        self.kernel.schedule(self.kernel.now + PENDING, self)


def own_kernel(count: int = 200_000) -> Row:
    """Return the speed of events without an action, by agents written in Python, in the form of this process."""

    def run() -> None:
        kernel = Kernel()
        for first in range(PENDING):
            kernel.schedule(first + 1, Waiter(kernel))
        kernel.run_until(count)

    return row(
        f"this kernel, {form.running}: events of Python agents", "events", Rate(count, median_of(REPEATS, run)[1])
    )


def heap(count: int = 1_000_000) -> Rate:
    """Measure heapq alone, with the pushes and pops of a kernel: the lower bound of the cost of any event loop."""

    def run() -> None:
        queue = [(time, time, None) for time in range(PENDING)]
        for number in range(PENDING, PENDING + count):
            time, _, _ = heappop(queue)
            heappush(queue, (time + PENDING, number, None))

    return Rate(count, median_of(REPEATS, run)[1])


def simpy_timeouts(count: int = 200_000) -> Rate | str:
    """Measure SimPy processes that only wait for timeouts."""
    if importlib.util.find_spec("simpy") is None:
        return f"simpy is not installed; {GET_THEM}"
    import simpy

    def waiter(env: simpy.Environment) -> Iterator[simpy.Event]:
        for _ in range(count // PENDING):
            yield env.timeout(PENDING)

    def run() -> None:
        env = simpy.Environment()
        for _ in range(PENDING):
            env.process(waiter(env))
        env.run()

    return Rate(count, median_of(REPEATS, run)[1])


def cocotb_i2c(rounds: int = 30) -> Rate | str:
    """Measure cocotbext-i2c's master and memory on a Verilog bus: bytes on the wire per second of simulation."""
    absent = [name for name in ("cocotb", "cocotbext.i2c") if not installed(name)]
    absent += [program for program in ("iverilog", "vvp") if shutil.which(program) is None]
    if absent:
        return f"not installed: {', '.join(absent)}; {GET_THEM}, and Icarus Verilog from the system's packages"
    from cocotb_tools.runner import get_runner

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        source, log, answer = folder / "bus.v", folder / "log.txt", folder / "result.json"
        source.write_text(BUS)
        runner = get_runner("icarus")
        found = []
        try:
            build = folder / "build"
            runner.build(sources=[source], hdl_toplevel="bus", build_dir=build, log_file=folder / "build.txt")
            for _ in range(REPEATS):
                answer.unlink(missing_ok=True)
                runner.test(
                    test_module="tests.bench.cocotb_i2c",
                    hdl_toplevel="bus",
                    build_dir=build,
                    test_dir=folder,
                    extra_env={"BENCH_ROUNDS": str(rounds), "BENCH_RESULT": str(answer), **FASTEST},
                    log_file=log,
                )
                found.append(json.loads(answer.read_text()))
        except (Exception, SystemExit) as error:  # the runner raises SystemExit if a tool fails
            last = log.read_text().splitlines()[-3:] if log.exists() else []
            return f"did not run ({type(error).__name__}: {error}) {' '.join(last)}".strip()
    return Rate(found[0]["wire_bytes"], middle([Seconds(run["wall"], run["cpu"]) for run in found]))


def installed(module: str) -> bool:
    try:
        return importlib.util.find_spec(module) is not None
    except ModuleNotFoundError:  # its package is absent
        return False
