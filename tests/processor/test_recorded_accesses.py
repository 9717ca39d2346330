"""What a record of an access says: the value that was read or written, also where the read itself changes it."""

from __future__ import annotations

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.processor.dsp import Dsp, DspPlan
from tests.processor.bench import Bench


def test_a_recorded_read_has_the_value_that_the_firmware_got():
    accesses: list[Record] = []
    recorder = Recorder()
    recorder.subscribe([Kind.ACCESS], accesses.append)
    bench = Bench([(1, 4, -1), (2, 5, -1)], recorder=recorder)
    got: list[int] = []

    def main() -> None:
        bench.cpu.compute(20)
        got.append(bench.flags.STATUS.all)
        got.append(bench.flags.COUNT.all)  # reading clears it
        got.append(bench.flags.COUNT.all)

    bench.run(main, 200)
    assert got == [5, 2, 0]
    assert [(a.what, a.value) for a in accesses] == [("R FLAGS.STATUS", 5), ("R FLAGS.COUNT", 2), ("R FLAGS.COUNT", 0)]


def test_the_field_that_firmware_named_is_recorded():
    accesses: list[Record] = []
    recorder = Recorder()
    recorder.subscribe([Kind.ACCESS], accesses.append)
    bench = Bench([], recorder=recorder)

    def main() -> None:
        assert bench.flags.STATUS.C == 0
        assert bench.flags.STATUS.all == 0
        bench.flags.STATUS.C = 1
        bench.flags.STATUS.all = 1

    bench.run(main, 200)
    assert [(a.what[0], a.field) for a in accesses] == [("R", "C"), ("R", ""), ("R", "C"), ("W", "C"), ("W", "")]


def test_each_half_of_a_pair_is_recorded_in_its_place():
    accesses: list[Record] = []
    recorder = Recorder()
    recorder.subscribe([Kind.ACCESS], accesses.append)
    kernel = Kernel()
    dsp = Dsp(kernel, Timebase(150_000_000), recorder, DspPlan("dsp", ("TIMER0",), {}))
    period = dsp.module("TIMER0").PRD
    got: list[int] = []

    def main() -> None:
        period.all = 0x1111_2222
        got.extend((period.half.MSW, period.half.LSW, period.all))
        period.half.MSW = 0x3333
        period.half.LSW = 0x4444

    dsp.start(main)
    kernel.run_until(20 * 1000)
    assert got == [0x1111, 0x2222, 0x1111_2222]
    assert [(a.what[0], a.value) for a in accesses if a.what.endswith("TIMER0.PRD")] == [
        ("W", 0x1111_2222),
        ("R", 0x1111_0000),
        ("R", 0x2222),
        ("R", 0x1111_2222),
        ("W", 0x3333_0000),
        ("W", 0x4444),
    ]
