"""From an interrupt request to the service routine and back in Python firmware: latency, boundaries, nesting, order."""

from __future__ import annotations

import pytest

from periph_sim.core.records import Kind
from periph_sim.f28335.system_options import SystemOptions
from periph_sim.processor.user_code import FirmwareError
from tests.processor.bench import Bench, recorder_of


def served(bench: Bench, cost: int = 20) -> None:
    """Give both lines routines that note their entry and their end."""

    def routine(name: str) -> None:
        bench.note(f"{name} in")
        bench.cpu.compute(cost)
        bench.pie_regs.PIEACK.all = 1
        bench.note(f"{name} out")

    bench.cpu.program.handle("SEQ1INT", lambda: routine("1"))
    bench.cpu.program.handle("SEQ2INT", lambda: routine("2"))
    bench.enable()


def entry_after(request: int, firmware, options: SystemOptions | None = None) -> int:
    bench = Bench([(request, 0, 0)], options=options)
    served(bench)
    log = bench.run(lambda: firmware(bench), request + 300)
    return next(cycle for what, cycle in log if what == "1 in") - request


@pytest.mark.rule("SYS-127", "SYS-128", "SYS-138", "SYS-139")
@pytest.mark.parametrize("latency", [14, 13, 16])
def test_open_int_latency_on_the_host(latency):
    options = SystemOptions(int_latency=latency)
    assert entry_after(100, lambda bench: bench.cpu.compute(1000), options) == latency


@pytest.mark.rule("SYS-138", "SYS-139")
@pytest.mark.parametrize("waits", [0, 1, 2])
def test_open_vector_fetch_waits_on_the_host(waits):
    options = SystemOptions(vector_fetch_waits=waits)
    assert entry_after(100, lambda bench: bench.cpu.compute(1000), options) == 14 + waits


@pytest.mark.rule("SYS-150")
@pytest.mark.parametrize("intm", [0, 1])
@pytest.mark.parametrize("wake", [0, 1, 16])
def test_open_idle_wake_on_the_host(wake, intm):
    """A request at 100 wakes the CPU at 104; with INTM = 0 the routine begins 10 cycles later, else main continues."""

    def main(bench: Bench) -> None:
        if intm:
            bench.cpu.dint()
        bench.cpu.idle()
        bench.note("1 in" if intm else "after IDLE")
        bench.cpu.compute(50)

    options = SystemOptions(idle_wake=wake)
    assert entry_after(100, main, options) == (4 if intm else 14) + wake


@pytest.mark.rule("SYS-130", "SYS-139")
@pytest.mark.parametrize("into", range(8))
def test_the_instruction_in_progress_completes_first(into):
    """Instructions of 7 cycles back to back from cycle 0; IFR latches 4 cycles after the request."""

    def main(bench: Bench) -> None:
        for _ in range(60):
            bench.cpu.instruction(7)

    request = 105 + into
    boundary = -(-(request + 4) // 7) * 7
    assert entry_after(request, main) == boundary + 10 - request


@pytest.mark.rule("SYS-131")
def test_a_repeated_instruction_is_not_interrupted():
    def main(bench: Bench) -> None:
        bench.cpu.instruction(100)  # as RPT #99, which begins before the request and is executed to its end
        bench.cpu.compute(100)

    assert entry_after(50, main) == 100 + 10 - 50


@pytest.mark.rule("SYS-137", "SYS-142", "SYS-100", "SYS-101")
def test_no_interrupt_is_taken_during_entry_routine_or_return():
    bench = Bench([(100, 0, 0), (103, 0, 1)])
    served(bench)
    log = bench.run(lambda: bench.cpu.compute(1000), 400)
    first_in, first_out, second_in, _ = (cycle for _, cycle in log)
    assert first_in == 114
    iret_done = first_out + 8
    assert second_in == iret_done + 10  # the acknowledge released the pulse earlier, but IRET had to complete


@pytest.mark.rule("SYS-143")
@pytest.mark.parametrize(("option", "instructions"), [("at_once", 0), ("after_one_instruction", 1)])
def test_open_irq_after_iret_on_the_host(option, instructions):
    bench = Bench([(100, 0, 0), (103, 0, 1)], options=SystemOptions(irq_after_iret=option))
    served(bench)

    def main() -> None:
        while True:
            bench.cpu.instruction(3)
            bench.note("main")

    log = bench.run(main, 300)
    names = [name for name, _ in log]
    out, second = names.index("1 out"), names.index("2 in")
    # the first "main" after the return belongs to the instruction that the first interrupt followed
    assert names[out + 1 : second].count("main") == instructions


@pytest.mark.rule("SYS-144", "SYS-145")
def test_setc_intm_delays_an_interrupt_until_clrc_intm():
    bench = Bench([(20, 0, 0)])
    served(bench)

    def main() -> None:
        bench.cpu.dint()
        bench.cpu.compute(98)
        bench.cpu.eint()
        bench.note("after eint")
        bench.cpu.compute(50)

    log = bench.run(main, 400)
    assert log[0] == ("1 in", 2 + 98 + 2 + 10)
    assert [name for name, _ in log] == ["1 in", "1 out", "after eint"]


@pytest.mark.rule("SYS-150")
@pytest.mark.parametrize("intm", [0, 1])
def test_idle_waits_for_an_enabled_interrupt(intm):
    bench = Bench([(200, 0, 0)])
    served(bench)
    bench.core.st1 |= intm

    def main() -> None:
        bench.cpu.idle()
        bench.note("awake")

    log = bench.run(main, 400)
    if intm:
        assert log == [("awake", 204)]
    else:
        assert [name for name, _ in log] == ["1 in", "1 out", "awake"]
        assert log[0] == ("1 in", 214)
    assert bench.kernel.events <= 6


def test_an_interrupted_computation_continues_for_its_remaining_cycles():
    bench = Bench([(100, 0, 0)])
    served(bench, cost=30)

    def main() -> None:
        bench.cpu.compute(500)
        bench.note("done")

    log = bench.run(main, 2000)
    entry, routine, iret = 10, 30 + 1, 8
    assert log[-1] == ("done", 500 + entry + routine + iret)


def test_an_interrupt_without_a_handler_ends_the_run_with_its_name():
    bench = Bench([(100, 0, 0)])
    bench.enable()
    with pytest.raises(
        FirmwareError, match=r"interrupt SEQ1INT was taken at cycle 114, but firmware gave it no handler"
    ):
        bench.run(lambda: bench.cpu.compute(1000), 400)


def test_an_interrupt_with_the_pie_disabled_ends_the_run():
    bench = Bench([(100, 0, 0)])
    served(bench)
    bench.pie.write(0, 0, 0)  # ENPIE = 0
    with pytest.raises(FirmwareError, match=r"INT1 was taken .* with PIECTRL\.ENPIE = 0"):
        bench.run(lambda: bench.cpu.compute(1000), 400)


@pytest.mark.parametrize(
    ("call", "cost", "ier", "intm", "eallow"),
    [
        (lambda cpu: cpu.or_ier(0x8004), 2, 0x8015, 1, 0),
        (lambda cpu: cpu.and_ier(0x0014), 2, 0x0010, 1, 0),
        (lambda cpu: cpu.eint(), 2, 0x0011, 0, 0),
        (lambda cpu: cpu.dint(), 2, 0x0011, 1, 0),
        (lambda cpu: cpu.eallow(), 4, 0x0011, 1, 1),
        (lambda cpu: (cpu.eallow(), cpu.edis()), 8, 0x0011, 1, 0),
        (lambda cpu: cpu.nop(), 1, 0x0011, 1, 0),
    ],
)
def test_effects_and_cycles_of_instructions_for_interrupts(call, cost, ier, intm, eallow):
    bench = Bench([])
    bench.core.ier = 0x0011

    def main() -> None:
        call(bench.cpu)
        bench.note("end")

    assert bench.run(main, 100) == [("end", cost)]
    assert (bench.core.ier, bench.core.intm, bench.core.eallow) == (ier, intm, eallow)


def test_a_note_of_the_cpu_is_counted_and_recorded_each_time():
    """Two routines reach IRET with INTM = 0."""
    recorder, records = recorder_of(Kind.NOTE)
    bench = Bench([(100, 0, 0), (300, 0, 0)], recorder=recorder)
    bench.enable()

    def routine() -> None:
        bench.pie_regs.PIEACK.all = 1
        bench.cpu.nop()
        bench.cpu.nop()
        bench.cpu.eint()

    bench.cpu.program.handle("SEQ1INT", routine)
    bench.run(lambda: bench.cpu.compute(1000), 900)
    ((note, count),) = bench.processor.notes.counts.items()
    assert (note.code, count) == ("duty", 2) and note.text.startswith("IRET was reached with INTM = 0")
    assert [(r.what, r.value, r.text) for r in records] == [("duty", n, note.text) for n in (1, 2)]


@pytest.mark.rule("SYS-126")
@pytest.mark.parametrize(("field", "pause", "reported"), [("all", 0, 1), ("PIEACK", 0, 1), ("PIEACK", 1, 0)])
def test_pieack_and_eint_without_a_nop_between_are_noted_for_word_and_field_writes(
    field: str, pause: int, reported: int
):
    """The routine writes PIEACK, executes a NOP or not, and then CLRC INTM."""
    bench = Bench([(100, 0, 0)])
    bench.enable()

    def routine() -> None:
        setattr(bench.pie_regs.PIEACK, field, 1)
        if pause:
            bench.cpu.instruction(pause)
        bench.cpu.eint()
        bench.cpu.compute(20)
        bench.cpu.dint()

    bench.cpu.program.handle("SEQ1INT", routine)
    bench.run(lambda: bench.cpu.compute(1000), 900)
    assert [note.source for note in bench.processor.notes.counts] == ["SPRZ272N section 3.1.1"] * reported


@pytest.mark.parametrize("into", range(8))
def test_after_main_returns_service_routines_still_run(into: int):
    """After main, the CPU is in an endless branch of 4 cycles; IFR latches 4 cycles after the request."""

    def main(bench: Bench) -> None:
        bench.cpu.compute(50)
        ended.append(bench.cpu.cycle)

    ended: list[int] = []
    request = 200 + into
    latency = entry_after(request, main)
    boundary = ended[0] + -(-(request + 4 - ended[0]) // 4) * 4
    assert latency == boundary + 10 - request


def test_after_main_returns_each_request_is_served_and_masked_ones_are_not():
    bench = Bench([(cycle, 0, 0) for cycle in (200, 500, 800)])
    served(bench)
    log = bench.run(lambda: bench.cpu.compute(20), 1200)
    assert [what for what, _ in log] == ["1 in", "1 out"] * 3
    masked = Bench([(200, 0, 0)])
    masked.cpu.program.handle("SEQ1INT", lambda: masked.note("1 in"))
    assert masked.run(lambda: masked.cpu.compute(20), 1200) == []
    assert masked.cpu.program.finished
