"""Posted writes: when they land, which reads wait for them, which overtake them, and what an interrupt sees.

A diagram has a row for each register and direction and a column for each cycle; `^` marks the cycle in which the access
takes effect, and `end` the one in which main has issued everything. A read in the cycle of a landing comes before it.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from msgspec.structs import replace

from periph_sim.core.records import Kind
from periph_sim.f28335.cpu.code_costs import BARE
from periph_sim.f28335.descriptor import Frame
from periph_sim.f28335.system_options import SystemOptions
from tests.processor.bench import Bench, recorder_of, unit
from tests.waves import Diagram, tidy

TICKS = 20  # a cycle


def drawn(firmware: Callable[[Bench], None], length: int, **made: object) -> Diagram:
    recorder, records = recorder_of(Kind.ACCESS, Kind.IRQ)
    bench = Bench(made.pop("changes", []), recorder=recorder, **made)

    def main() -> None:
        firmware(bench)
        bench.note("end")

    bench.run(main, 200)
    rows: dict[str, list[int]] = {}
    for record in records:
        name = record.what.replace("FLAGS.", "").replace("PIE.", "") if record.kind is Kind.ACCESS else record.what
        if record.kind is Kind.ACCESS or record.value:
            rows.setdefault(name, []).append(record.tick // TICKS)
    rows["end"] = [cycle for what, cycle in bench.log if what == "end"]
    width = max(map(len, rows))
    return Diagram(
        "\n".join(
            f"{name:{width}} {''.join('^' if cycle in cycles else '.' for cycle in range(length))}"
            for name, cycles in rows.items()
        )
    )


def set_c(bench: Bench) -> None:
    bench.flags.STATUS.C = 1


@pytest.mark.rule("SYS-037")
def test_a_field_write_takes_the_cycles_of_a_read_and_lands_two_cycles_after_its_read():
    assert drawn(set_c, 8) == tidy("""
        R STATUS ..^.....
        W STATUS ....^...
        end      ...^....
    """)


def test_plain_write_lands_two_cycles_after_it_was_issued():
    def main(bench: Bench) -> None:
        bench.flags.STATUS.all = 4

    assert drawn(main, 6) == tidy("""
        W STATUS ..^...
        end      .^....
    """)


@pytest.mark.rule("SYS-041")
def test_read_in_the_protected_block_waits_for_the_write_of_a_field_write():
    def main(bench: Bench) -> None:
        bench.flags.STATUS.C = 1
        _ = bench.flags.COUNT.all

    assert drawn(main, 11) == tidy("""
        R STATUS ..^........
        W STATUS ....^......
        R COUNT  ........^..
        end      .........^.
    """)


@pytest.mark.rule("SYS-044", "SYS-042")
def test_read_outside_of_the_block_overtakes_the_write_of_a_field_write():
    def main(bench: Bench) -> None:
        bench.flags.STATUS.C = 1
        _ = bench.pie_regs.PIECTRL.all

    assert drawn(main, 8) == tidy("""
        R STATUS  ..^.....
        R PIECTRL ....^...
        W STATUS  ....^...
        end       .....^..
    """)


@pytest.mark.parametrize("event", range(8))
def test_a_read_in_the_cycle_of_a_landing_precedes_it(event):
    recorder, accesses = recorder_of(Kind.ACCESS)
    bench = Bench([(event, 1, -1)], recorder=recorder)
    bench.run(lambda: (set_c(bench), bench.pie_regs.PIECTRL.all), 100)
    assert [(a.tick // TICKS, a.what) for a in accesses] == [
        (2, "R FLAGS.STATUS"),
        (4, "R PIE.PIECTRL"),
        (4, "W FLAGS.STATUS"),
    ]


def sees_the_write(between: int, options: SystemOptions | None = None) -> bool:
    """True if a read after `between` instructions sees the count that the write reloads."""
    dsp, kernel = unit("TIMER0", code=BARE, system=options or SystemOptions())
    timer = dsp.module("TIMER0")
    seen: list[int] = []

    def main() -> None:
        timer.PRD.all = 5_000_000
        dsp.cpu.compute(20)
        timer.TCR.all = 0x30  # TRB, TSS
        for _ in range(between):
            dsp.cpu.nop()
        seen.append(timer.TIM.all)

    dsp.start(main)
    kernel.run_until(10_000)
    return seen[0] == 5_000_000


@pytest.mark.rule("SYS-044")
@pytest.mark.parametrize(("between", "overtakes"), [(0, True), (1, False)])
def test_read_of_a_timer_overtakes_the_write_before_it(between, overtakes):
    """TRB reloads the count from PRD; TIM is read by the next instruction, or by the one after that."""
    assert sees_the_write(between) != overtakes


@pytest.mark.rule("SYS-043")
def test_a_read_of_the_register_just_written_waits_in_any_frame():
    """In frame 0 the write takes 1 cycle, the protection 3 and the read 2."""

    def main(bench: Bench) -> None:
        bench.pie_regs.PIEIER3.all = 5
        bench.note(f"PIEIER3={bench.pie_regs.PIEIER3.all}")

    bench = Bench([])
    bench.run(lambda: main(bench), 100)
    assert bench.log == [("PIEIER3=5", 1 + 3 + 2)]


def test_writes_land_in_the_order_in_which_they_were_issued():
    def main(bench: Bench) -> None:
        bench.flags.STATUS.C = 1
        bench.pie_regs.PIEIER1.all = 1
        bench.pie_regs.PIEIER2.all = 1

    assert drawn(main, 9) == tidy("""
        R STATUS  ..^......
        W STATUS  ....^....
        W PIEIER1 .....^...
        W PIEIER2 ......^..
        end       .....^...
    """)


def test_routine_entered_between_issue_and_landing_sees_the_write():
    """The interrupt is taken at the boundary after the field write, one cycle before the write lands."""

    def main(bench: Bench) -> None:
        bench.enable()

        def routine() -> None:
            bench.note(f"C={bench.flags.STATUS.C}")

        bench.cpu.program.handle("SEQ1INT", routine)
        bench.cpu.compute(19)
        bench.flags.STATUS.C = 1  # C is set since cycle 2; writing 1 clears it

    changes = [(2, 4, -1), (18, 4, 0)]
    assert drawn(main, 49, changes=changes) == tidy("""
        R STATUS .....................^............^..............
        W STATUS .......................^.........................
        SEQ1INT  ................................^................
        end      ...........................................^.....
    """)
    bench = Bench([(2, 4, -1), (18, 4, 0)])
    bench.run(lambda: main(bench), 200)
    assert bench.log == [("C=0", 35)]


def test_a_landing_write_has_the_place_and_cause_of_the_statement_that_issued_it():
    """A routine's last write lands after its IRET; a write of main lands while a routine is being entered."""
    recorder, records = recorder_of(Kind.ACCESS, Kind.IRQ)
    bench = Bench([(18, 0, 0)], recorder=recorder)

    def last_write_of_routine() -> None:
        bench.pie_regs.PIEACK.all = 1

    def main() -> None:
        bench.enable()
        bench.cpu.program.handle("SEQ1INT", last_write_of_routine)
        bench.cpu.compute(19)
        bench.flags.STATUS.C = 1
        bench.cpu.compute(100)

    bench.run(main, 300)
    (entered,) = [r.number for r in records if r.kind is Kind.IRQ and r.value]
    writes = {r.what: (r.text.partition(":")[0], r.cause) for r in records if r.what.startswith("W ")}
    assert writes == {"W FLAGS.STATUS": ("main", 0), "W PIE.PIEACK": ("last_write_of_routine", entered)}


def test_write_of_the_last_instruction_of_main_lands():
    bench = Bench([(1, 4, -1)])
    bench.run(lambda: (bench.cpu.compute(9), set_c(bench)), 100)
    assert bench.chip.status == 0
    assert bench.cpu.program.finished


def test_protected_write_that_is_followed_by_edis_lands():
    dsp, kernel = unit(code=BARE)

    def main() -> None:
        dsp.eallow()
        dsp.module("SYS").PCLKCR0.all = 0x10
        dsp.edis()

    dsp.start(main)
    kernel.run_until(10_000)
    assert dsp.control.enabled("I2CAENCLK")
    assert not dsp.processor.notes.counts


@pytest.mark.rule("SYS-036")
def test_two_writes_to_frame_1_land_two_cycles_apart():
    def main(bench: Bench) -> None:
        bench.flags.STATUS.all = 0
        bench.flags.STATUS.all = 0

    assert drawn(main, 7, frame=Frame.PF1) == tidy("""
        W STATUS ..^.^..
        end      ...^...
    """)


@pytest.mark.parametrize(("lands", "overtaking"), [(2, 1), (4, 3)])
def test_open_write_lands(lands, overtaking):
    """A read of a register in frame 0 up to this many instructions after a write returns the old value."""
    options = SystemOptions(write_lands=lands)

    assert [sees_the_write(between, options) for between in range(6)] == [between >= overtaking for between in range(6)]


@pytest.mark.parametrize("lands", [2, 4])
def test_the_protection_covers_any_delay_of_the_landing(lands):
    bench = Bench([(1, 4, -1)], options=SystemOptions(write_lands=lands, pf2_read_ws=0))
    bench.run(lambda: (bench.cpu.compute(9), set_c(bench), bench.note(f"C={bench.flags.STATUS.C}")), 100)
    assert bench.log[0][0] == "C=0"


STEPS = st.lists(
    st.tuples(st.sampled_from(["field", "plain", "pie", "read", "read pie", "spin", "compute"]), st.integers(0, 3)),
    max_size=12,
)
CHANGES = st.lists(st.tuples(st.integers(1, 300), st.integers(0, 7), st.sampled_from([-1, -1, 0, 1])), max_size=10)


@given(steps=STEPS, changes=CHANGES, lands=st.sampled_from([2, 4]), loop=st.integers(3, 12))
@example(
    steps=[("plain", 0), ("spin", 2)], changes=[(1, 4, -1)], lands=4, loop=3
)  # a pass that is shorter than the delay of the landing
def test_skipping_polls_with_posted_writes_gives_the_records_of_polling(steps, changes, lands, loop):
    skipped, polled = (played(steps, changes, lands, loop, skip) for skip in (True, False))
    assert skipped == polled


@given(steps=STEPS, changes=CHANGES, lands=st.sampled_from([2, 4]))
def test_records_come_in_the_order_of_their_ticks(steps, changes, lands):
    ticks = [record[0] for record in played(steps, changes, lands, 10, True)[1]]
    assert ticks == sorted(ticks)


def played(steps, changes, lands: int, loop: int, skip: bool):
    """Return notes and records without polls, since of skipped passes only the last is recorded."""
    recorder, records = recorder_of(Kind.ACCESS, Kind.IRQ, Kind.FLAG)
    options, code = SystemOptions(write_lands=lands), replace(BARE, poll_pass=loop)
    bench = Bench(list(changes), options=options, code=code, skip_polls=skip, recorder=recorder)
    flags, pie, cpu = bench.flags, bench.pie_regs, bench.cpu

    def routine(name: str) -> None:
        flags.STATUS.C = 1
        bench.note(f"{name} {flags.STATUS.all}")
        pie.PIEACK.all = 1

    cpu.program.handle("SEQ1INT", lambda: routine("1"))
    cpu.program.handle("SEQ2INT", lambda: routine("2"))
    bench.enable()
    conditions = [
        lambda: flags.STATUS.A,
        lambda: flags.STATUS.B or pie.PIEIER2.INTx2,
        lambda: pie.PIEIER2.INTx1,
        lambda: True,
    ]

    def main() -> None:
        for what, more in steps:
            if what == "field":
                flags.STATUS.C = 1
            elif what == "plain":
                flags.STATUS.all = 4
            elif what == "pie":
                pie.PIEIER2.all = more
            elif what == "read":
                bench.note(f"read {flags.STATUS.all}")
            elif what == "read pie":
                bench.note(f"pie {pie.PIEIER2.all} {pie.PIEIFR1.all}")
            elif what == "spin":
                bench.waits.spin(conditions[more])
            else:
                cpu.compute(3 * more)
            bench.note(what)

    log = bench.run(main, 900)
    kept = [r for r in records if r.what not in ("R FLAGS.STATUS", "R PIE.PIEIER2")]
    numbers = {r.number: i for i, r in enumerate(kept)}
    return log, [(r.tick, r.where, r.what, r.value, numbers.get(r.cause)) for r in kept]
