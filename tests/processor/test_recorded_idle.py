"""IDLE is a wait that is recorded as such, where somebody records waits."""

from __future__ import annotations

from periph_sim.core.records import Kind, Record, Recorder
from tests.processor.bench import Bench


def test_idle_is_recorded_from_the_instruction_to_the_interrupt() -> None:
    found: list[Record] = []
    recorder = Recorder()
    recorder.subscribe([Kind.WAIT], found.append)
    bench = Bench([(200, 0, 0)], recorder=recorder)
    bench.enable()
    bench.cpu.handle("SEQ1INT", lambda: bench.note("served"))

    def firmware() -> None:
        bench.cpu.compute(50)
        bench.cpu.idle()
        bench.note("awake")

    log = dict(bench.run(firmware, 600))
    assert [(record.what, record.value) for record in found] == [("IDLE", 1), ("IDLE", 0)]
    begin, end = (bench.clock.cycle_at(record.tick) for record in found)
    assert 50 <= begin < 60 and 200 <= end <= log["served"] <= log["awake"]
