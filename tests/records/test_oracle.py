"""`why` finds the same chains as an independent search (`tests/records/oracle.py`), in runs of all kinds."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable
from fractions import Fraction
from random import Random

import pytest

from periph_sim.core.records import RECORDED, Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.firmware import sci_fifo_receiver
from periph_sim.processor.dsp import Dsp
from periph_sim.records.cause_trace.why import why
from periph_sim.records.run import Run
from periph_sim.replay.i2c_closed_loop import I2cReplay
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.scene import Scene
from periph_sim.traces import formats
from periph_sim.traces.formats.record_table import Columns
from tests.records.oracle import Oracle
from tests.scene.runs import TIMING

POLLED = ("R I2C-A.I2CSTR", "R SCI-A.SCIFFRX")
OF_EACH = 26  # chains per run through a read of one of these, and the same number of others
DEPTH = 8
Subscribe = Callable[[Recorder, Timebase], None]


def scene(name: str, seconds: str, *changes: str) -> Callable[[Subscribe], tuple[Case, int]]:
    def play(subscribe: Subscribe) -> tuple[Case, int]:
        case = load(TIMING / f"{name}.toml", list(changes))
        running = Scene(case, subscribe)
        running.run(Fraction(seconds))
        return case, running.kernel.now

    return play


def replay(subscribe: Subscribe) -> tuple[Case, int]:
    case = load(TIMING / "responder.toml", [])
    player = I2cReplay(
        case, formats.read(TIMING.parent / "traces" / "imu_session.sr"), "SCL", "SDA", subscribe=subscribe
    )
    player.run()
    return case, player.kernel.now


def echo(subscribe: Subscribe) -> tuple[Case, int]:
    """Firmware that polls and sends each byte back, with reads of a field and of a whole register.

    Every fourth byte is delayed, so that several bytes wait.
    """

    def main(dsp: Dsp, settings: object) -> None:
        sci_fifo_receiver(dsp, 40, 16)
        sci = dsp.module("SCI-A")
        sci.SCIFFTX.TXFIFOXRESET = 1
        count = 0
        while True:
            dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
            count += 1
            if count % 4 == 0:
                dsp.compute(30_000)
            byte = sci.SCIRXBUF.all & 0xFF
            if sci.SCIFFRX.all & 0x8000 == 0:  # RXFFOVF
                sci.SCITXBUF.all = byte

    case = load(TIMING / "uart_logger.toml", [])
    running = Scene(case, subscribe, {"dsp": Firmware("echo", main, None)})
    running.run(Fraction("0.045"))
    return case, running.kernel.now


RUNS: dict[str, Callable[[Subscribe], tuple[Case, int]]] = {
    # Frames end during reads, at varying phases, and their routine takes long.
    "imu_hil": scene(
        "imu_hil_published",
        "0.09",
        "host.first=3.9 ms",
        "host.period=10.3 ms",
        "host.jitter=2 ms",
        "unit.dsp.settings.frame_cost=60 us",
    ),
    "two_dsps": scene("two_dsps", "0.045"),
    "sci": echo,
    "replay": replay,
}


@pytest.fixture(scope="module", params=RUNS)
def recorded(request: pytest.FixtureRequest) -> tuple[list[Record], Run]:
    records: list[Record] = []
    bases: list[Timebase] = []

    def subscribe(recorder: Recorder, timebase: Timebase) -> None:
        bases.append(timebase)
        recorder.subscribe(RECORDED, records.append)

    case, end = RUNS[request.param](subscribe)
    columns = Columns()
    for record in records:
        columns.add(record)
    return records, Run(columns.table(Fraction(bases[0].per_second), end, case.recorded_modules, {}))


def test_the_chains_of_why_are_those_of_the_oracle(recorded: tuple[list[Record], Run]):
    records, run = recorded
    oracle = Oracle(records, run.cycles.ticks)
    changes = [r for r in records if r.kind in (Kind.FLAG, Kind.EDGE, Kind.IRQ) and _alone(records, r)]
    Random(1).shuffle(changes)
    left = {True: OF_EACH, False: OF_EACH}
    for change in changes:
        expected = oracle.chain(change, DEPTH)
        through = any(oracle.by_number[number].what in POLLED for number, _ in expected)
        if not left[through]:
            continue
        left[through] -= 1
        answer = why(run, f"{change.where}{_name(change)}@{Fraction(change.tick, int(run.per_second))} s", DEPTH)
        assert [(step.record.number, step.aside) for step in answer.back] == expected, _listed(oracle, expected)
    assert left == {True: 0, False: 0}


def test_the_value_of_a_read_is_that_of_the_last_change(recorded: tuple[list[Record], Run]):
    """For each read that names a field, the change that is its cause has the value that was read."""
    records, run = recorded
    oracle = Oracle(records, run.cycles.ticks)
    looks = [r for r in records if r.kind is Kind.ACCESS and r.field and r.what in POLLED]
    for look in looks[:: max(len(looks) // 60, 1)]:
        module, _, name = look.what[2:].partition(".")
        change, f = oracle._seen(look), oracle.register(module, name)[look.field]
        assert f.extract(look.value) == (f.reset if change is None else change.value)


def _alone(records: list[Record], of: Record) -> bool:
    """True if no other record of the same subject has its tick, so that a question with this time is about it."""
    place = bisect_left(records, of.number, key=lambda record: record.number)
    near = [r for r in records[max(place - 40, 0) : place + 40] if r.tick == of.tick and r[2:5] == of[2:5]]
    holds = [
        r for r in records[place : place + 40] if r.kind is Kind.HOLD and r.tick == of.tick and r.where == of.where
    ]
    return near == [of] and not holds


def _name(change: Record) -> str:
    return "" if change.kind is Kind.EDGE else f".{change.what}"


def _listed(oracle: Oracle, chain: list[tuple[int, bool]]) -> str:
    return "\n".join(f"{'  ' * beside}{oracle.by_number[number]}" for number, beside in chain)
