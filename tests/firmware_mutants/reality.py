"""Decide whether a mutant is real: it runs in 200 phases and is compared with the unchanged firmware.

    Random(seed) --> 200 phases: a bench, the begin of its host or its head, the seed of its case
    each phase ----> unchanged firmware --> Behaviour
               '---> mutant ----> Behaviour --> first difference: bytes, order on the wires, a missed deadline

The benches are shortened runs of the shipped cases. Their budgets are not used: DEADLINES and AGE replace them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from random import Random
from time import process_time
from typing import Any, NamedTuple

from periph_sim.bus.i2c.transfer import Transfer
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import NO_TIME, Timebase
from periph_sim.scene.case.load import load
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.scene import Scene

from .changes import Mutant
from .trials import BREAK, RESET, ROOT, STALLED, Run, mutated, unchanged

PHASES = 200
PERIOD = 20_000  # us, of host and head

# Requirements of the bench, independent of the budgets of a case: name -> (measure, limits, derivation).
DEADLINES = {
    "round": ("missed rounds", "max=0", "each round ends before the next is due, 20 ms later"),
    "acknowledge": ("nacked rounds", "max=0", "each address is acknowledged in its ninth clock"),
    "SCL": ("stretch", 'max="0 us"', "the head's driver knows no stretching: a byte is there before its first clock"),
    "FIFO": ("overruns", "max=0", "a frame is read before 16 words wait: 4 characters, 347 us, behind its last"),
}
# Data age: the published firmware runs its models after a round, so a frame waits up to 21 ms for them, and its values
# up to 20 ms for the next round. The robust one runs them when a frame is complete, at most 21 ms before a round;
# within 0.5 ms of a round it waits for the end of the round, 2.6 ms.
AGE = {
    "imu_hil": "41 ms",
    "imu_hil_robust": "24 ms",
}
HOST, HEAD, BETWEEN = (
    "host.first",
    "controller.first",
    "between",
)  # the key of the start that is drawn within its period
BENCHES = {  # the shipped cases of a firmware with earlier faults: a run, and which start is drawn
    "imu_hil": (
        (Run("imu_hil", "imu_hil", "0.048"), HOST),
        (Run("imu_hil", "imu_hil_400k", "0.047"), HOST),
        (Run("imu_hil", "imu_hil_by_frame", "0.048"), BETWEEN),
    ),
    "imu_hil_robust": (
        (Run("imu_hil_robust", "imu_hil", "0.048"), HOST),
        (Run("imu_hil_robust", "imu_hil_400k", "0.047"), HOST),
        (Run("imu_hil_robust", "imu_hil_broken_line", "0.07", BREAK), HEAD),
        (Run("imu_hil_robust", "imu_hil_lost_byte", "0.09", ("host.lose=[[1, 5], [3, 0]]",)), HEAD),
        (Run("imu_hil_robust", "imu_hil", "0.048"), HOST),
        (Run("imu_hil_robust", "imu_hil_silent_host", "0.09", ('host.silent=[["30 ms", "40 ms"]]',)), HEAD),
        (Run("imu_hil_robust", "imu_hil_doubled_frame", "0.048"), HOST),
        (Run("imu_hil_robust", "imu_hil_stuck_sda", "0.07", ("fault.0.at=38 ms", "fault.0.times=1")), HOST),
        (Run("imu_hil_robust", "imu_hil_400k", "0.047"), HOST),
        (RESET._replace(seconds="0.07"), HOST),
        (Run("imu_hil_robust", "imu_hil_glitches", "0.08"), HOST),
        (
            Run("imu_hil_robust", "imu_hil_module_reset", "0.07", ("fault.0.at=45.13 ms", "fault.0.every=20.29 ms")),
            HOST,
        ),
    ),
}
BYTES, ORDER, DEADLINE, ENDS, SLOW = "bytes", "order", "deadline", "ends", "slow"
PATIENCE = (
    40  # s of CPU time for all phases of a mutant, which take 2 s; it takes longer if its waits execute each pass
)


class Phase(NamedTuple):
    """A bench, and the start of its host or head within its period, as changes of the case."""

    run: Run
    changes: tuple[str, ...]


class Difference(NamedTuple):
    """A difference from the unchanged firmware.

    kind: BYTES, ORDER, DEADLINE, ENDS, or SLOW if the decision takes too long.
    phase: the number of the phase.
    """

    kind: str
    what: str
    phase: int


@dataclass
class Behaviour:
    """The measured behaviour of firmware in a bench.

    bytes: each addressed part of a transfer, with A for the ACK or N for the NACK of each byte.
    order: events on SDA, SCL and MODEL, with their ticks.
    missed: names of missed deadlines.
    """

    bytes: list[str] = field(default_factory=list)
    order: list[tuple[int, str]] = field(default_factory=list)
    missed: frozenset[str] = frozenset()

    def difference(self, usual: Behaviour) -> tuple[str, str]:
        """Return kind and text of the first difference from the usual behaviour, or two empty texts."""
        missed = sorted(self.missed - usual.missed)
        if missed:
            return DEADLINE, missed[0]
        for ours, theirs in zip(self.bytes, usual.bytes, strict=False):
            if ours != theirs:
                return BYTES, f"{ours}, not {theirs}"
        if len(self.bytes) != len(usual.bytes):
            return BYTES, f"{len(self.bytes)} transfers, not {len(usual.bytes)}"
        for one, other in zip(_names(self.order), _names(usual.order), strict=False):
            if one != other:
                return ORDER, f"{one}, not {other}"
        return "", ""


def _names(order: list[tuple[int, str]]) -> list[str]:
    return [name for _, name in sorted(order)]


@cache
def phases(file: str, seed: int, count: int = PHASES) -> tuple[Phase, ...]:
    """Return this many phases of the benches of a firmware, which take turns."""
    draw, benches = Random(seed), BENCHES[file]
    return tuple(_phase(*benches[number % len(benches)], draw) for number in range(count))


def _phase(run: Run, drawn: str, draw: Random) -> Phase:
    """Draw a phase. If frames are damaged, the head's start is drawn, so that the damage is at a fixed place."""
    first = draw.randrange(PERIOD)
    at = {HOST: 2000 + first, HEAD: 5000 + first, BETWEEN: 8000 + first * 7 // 10}[drawn]
    return Phase(run, (f"{HEAD if drawn == HEAD else HOST}={at} us", f"seed={draw.randrange(1, 10**6)}"))


def difference(mutant: Mutant, seed: int, count: int = PHASES) -> Difference | None:
    """Return the first difference, or None if the mutant behaves as the unchanged firmware in all these phases."""
    return next(differences(mutant, seed, count), None)


def differences(mutant: Mutant, seed: int, count: int = PHASES) -> Iterator[Difference]:
    """Yield a difference for each phase that has one."""
    modules: dict[str, Any] = {}
    began = process_time()
    for number, phase in enumerate(phases(mutant.file, seed, count)):
        firmware = phase.run.firmware
        if process_time() - began > PATIENCE:
            yield Difference(SLOW, f"{number} of {count} phases alike", number)
            return
        try:
            if firmware not in modules:
                modules[firmware] = mutated(firmware, mutant)
            found = behaviour(phase, modules[firmware])
        except Exception as error:  # firmware that cannot continue
            yield Difference(ENDS, type(error).__name__, number)
            return
        kind, what = found.difference(_usual(phase))
        if kind:
            yield Difference(kind, what, number)


@cache
def _usual(phase: Phase) -> Behaviour:
    return behaviour(phase, unchanged(phase.run.firmware))


def behaviour(phase: Phase, module: Any) -> Behaviour:
    """Return the behaviour of this firmware in a phase."""
    run, found = phase.run, Behaviour()
    rows = [(name, measure, limit) for name, (measure, limit, _) in DEADLINES.items()]
    rows.append(("data age", "age", f'max="{AGE[run.firmware]}"'))
    budgets = ", ".join(f'{{name="{name}", measure="{measure}", {limit}}}' for name, measure, limit in rows)
    changes = [change for change in run.changes if not change.startswith("budget.")]
    case = load(ROOT / "timing" / f"{run.case}.toml", [*changes, f"budget=[{budgets}]", *phase.changes, STALLED])

    def edge(record: Record) -> None:
        if record.tick:
            found.order.append((record.tick, f"{record.where} {record.what}"))

    def subscribe(recorder: Recorder, _: Timebase) -> None:
        recorder.subscribe([Kind.EDGE], edge, {Kind.EDGE: ["MODEL"]})

    def transfer(over: Transfer) -> None:
        for part in over.phases:
            if part.start_at != NO_TIME:
                what = f"{part.address:#x} {'R' if part.read else 'W'}"
                found.order.append((part.start_at, f"START {what}"))
                data = part.got if part.read else part.data[: len(part.acks)]
                acks = "".join("NA"[acked] for acked in (part.acked, *part.acks))
                found.bytes.append(f"{what} {data.hex(' ')} {acks}")
        found.order.append((over.stop_at, "STOP"))

    scene = Scene(case, subscribe, programs={"dsp": Firmware("trial", module.main, module.Settings)})
    assert scene.head is not None
    scene.head.on_transfer.append(transfer)
    result = scene.run(Fraction(run.seconds))
    found.missed = frozenset(verdict.name for verdict in result.budgets if verdict.broken)
    if scene.stalled:
        found.missed |= {"firmware waits for ever"}
    return found
