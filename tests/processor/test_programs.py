"""Programs that are no Python firmware: time, bus and interrupts serve them as they serve firmware."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.core.kernel import CPU
from periph_sim.core.records import Kind, Record
from periph_sim.f28335.descriptor import Frame
from periph_sim.f28335.memory.memory_map import ModuleRange, NoSuchAddress
from periph_sim.processor.processor import Program
from periph_sim.processor.user_code import FirmwareError
from tests.processor.bench import Bench, recorder_of
from tests.processor.scripted_program import Op, ScriptedProgram, Step

TICKS = 20  # of a cycle
MAIN, ROUTINE = 0x9000, 0x30_A000  # code addresses: in L1, and one that needs all 22 bits
STATUS, COUNT, PIEACK, SEQ1INT = 0x7100, 0x7101, 0x0CE1, 0x0D40


def work(cycles: int) -> Step:
    return Step(Op.WORK, 0, cycles)


def scripted(bench: Bench, *main: Step, routine: tuple[Step, ...] = ()) -> ScriptedProgram:
    """A program on the bench, begun now, with the vector of SEQ1INT stored as its start-up code would."""
    code = {MAIN: list(main), ROUTINE: [*routine, Step(Op.STORE, PIEACK, 1), Step(Op.IRET)]}
    program = ScriptedProgram(bench.processor, code, MAIN)
    bench.processor.bus.ram.put_word32(SEQ1INT, ROUTINE)
    bench.processor.start(program)
    return program


def bare(records: list[Record]) -> list[tuple[Any, ...]]:
    """Records without their place in the source, which only Python firmware has."""
    return [(r.tick, r.kind, r.where, r.what, r.value, r.cause) for r in records]


def test_an_interrupt_goes_through_the_table_and_the_stack_in_memory():
    """Request at 100, latched at 104; the vector is fetched one cycle later, the routine begins at 114."""
    bench = Bench([(100, 1, 0)])
    bench.enable()
    program = scripted(
        bench, Step(Op.SET, 0, 0xBEEF), work(99), *[work(1)] * 40, routine=(Step(Op.SET, 0, 7), Step(Op.LOAD, STATUS))
    )
    program.st0 = 0x1234
    bench.core.sp = 0x421
    st1, ram, inside = bench.core.st1, bench.processor.bus.ram, []

    def look() -> None:
        inside.append(([hex(ram.word(0x422 + i)) for i in (0, 2, 8, 10, 12, 13)], bench.core.sp, bench.core.ier))

    bench.kernel.call_at(115 * TICKS, look)
    bench.kernel.run_until(400 * TICKS)
    assert program.entered == [(ROUTINE, 114)]
    back_to = MAIN + 2 + 4  # the step that was next
    assert inside == [(["0x1234", "0xbeef", hex(st1), "0x1", hex(back_to), "0x0"], 0x421 + 15, 0)]
    assert (program.al, program.st0, bench.core.sp, bench.core.ier) == (0xBEEF, 0x1234, 0x421, 1)
    assert program.seen == [(1, 115 + 2)]  # two wait states of frame 2
    #         SET and 139 cycles, entry, SET, load, store of PIEACK, IRET
    assert program.returned_at == 140 + 10 + 1 + 3 + 1 + 8
    assert program.finished


def test_it_is_run_up_to_where_something_else_acts_and_no_further():
    """An event of somebody else's at 50 changes what a load at 52 sees, and not what one at 49 saw."""
    bench = Bench([(50, 3, -1)])
    program = scripted(bench, work(47), Step(Op.LOAD, STATUS), Step(Op.LOAD, STATUS))
    bench.kernel.run_until(200 * TICKS)
    assert program.seen == [(0, 49), (3, 52)]
    assert program.runs[0] == 49  # it may go on to before 50; the first load ends at 50


def test_an_interrupt_meanwhile_waits_for_the_boundary():
    bench = Bench([(100, 1, 0)])
    bench.enable()
    program = scripted(bench, work(130), work(10))
    bench.kernel.run_until(400 * TICKS)
    assert program.entered == [(ROUTINE, 130 + 10)]


def test_a_routine_may_return_to_another_place_than_it_came_from():
    """It moves the stack to a frame that it made: the program goes on where that says."""
    bench = Bench([(100, 1, 0)])
    bench.enable()
    program = scripted(bench, work(100), work(100), routine=(work(20),))
    task = 0x9800
    program._code[task] = Step(Op.SET, 0, 0x55)
    ram = bench.processor.bus.ram

    def switch() -> None:
        ram.put_words(0x600, [0, 0, 9, 0, 0, 0, 0, 0, 0x080B, 0, 0x40, 0, task & 0xFFFF, task >> 16])
        bench.core.sp = 0x600 + 15

    bench.kernel.call_at(215 * TICKS, switch)
    bench.kernel.run_until(500 * TICKS)
    assert (program.al, program.pc, bench.core.sp, bench.core.ier) == (0x55, task + 1, 0x600, 0x40)


@pytest.mark.parametrize("steps", [1, 7, 13])
def test_it_makes_the_same_records_as_python_firmware_that_does_the_same(steps: int):
    """Loads with an effect, posted writes and an interrupt, recorded by both: tick, cause and order are equal."""
    kinds = (Kind.ACCESS, Kind.IRQ, Kind.FLAG)
    changes = [(40, 5, -1), (100, 1, 0), (300, 4, -1)]

    def accesses(cpu: Any) -> None:
        for _ in range(steps):
            cpu.load(STATUS)
            cpu.store(STATUS, 4)
            cpu.load(COUNT)
            cpu.instruction(30)
        cpu.compute(150)

    recorder, expected = recorder_of(*kinds)
    firmware = Bench(changes, recorder=recorder)
    firmware.enable()

    def routine() -> None:
        firmware.cpu.load(COUNT)
        firmware.cpu.store(PIEACK, 1)

    firmware.cpu.program.handle("SEQ1INT", routine)
    firmware.run(lambda: accesses(firmware.cpu), 2000)
    recorder, found = recorder_of(*kinds)
    bench = Bench(changes, recorder=recorder)
    bench.enable()
    body = (Step(Op.LOAD, STATUS), Step(Op.STORE, STATUS, 4), Step(Op.LOAD, COUNT), work(30))
    program = scripted(bench, *body * steps, *[work(1)] * 150, routine=(Step(Op.LOAD, COUNT),))
    bench.kernel.run_until(2000 * TICKS)
    assert bare(found) == bare(expected) and len(found) > 3 * steps
    assert bench.processor.program is program and program.finished and firmware.cpu.program.finished


def test_it_runs_beside_python_firmware_that_reads_the_same_module():
    """COUNT is cleared by a read: who comes first has it, in the order of the cycles, whoever ran first."""
    recorder, found = recorder_of(Kind.ACCESS)
    one = Bench([(10, 1, -1), (60, 0, -1)], recorder=recorder)
    two = Bench([], beside=one, name="iss")
    two.memory.places["SHARED"] = ModuleRange("SHARED", 0x7200, 2, Frame.PF2, one.socket)
    program = scripted(two, work(20), Step(Op.LOAD, 0x7201), work(40), Step(Op.LOAD, 0x7201))

    def firmware() -> None:
        one.cpu.compute(30)
        one.note(f"COUNT {one.flags.COUNT.N}")
        one.cpu.compute(40)
        one.note(f"COUNT {one.flags.COUNT.N}")

    one.run(firmware, 500)
    assert program.seen == [(1, 22), (1, 65)]
    assert one.log == [("COUNT 0", 33), ("COUNT 0", 76)]
    assert [(r.where, r.what, r.value) for r in found] == [
        ("iss", "R SHARED.COUNT", 1),
        ("dsp", "R FLAGS.COUNT", 0),
        ("iss", "R SHARED.COUNT", 1),
        ("dsp", "R FLAGS.COUNT", 0),
    ]


def test_a_write_lands_on_the_way_to_a_later_cycle():
    """Posted in cycle 10, it takes effect at the end of cycle 12, in the middle of 40 cycles of work."""
    bench = Bench([(5, 4, -1)])
    program = scripted(bench, work(10), Step(Op.STORE, STATUS, 4), work(40))
    seen: list[tuple[int, int]] = []
    for cycle in (12, 13):
        bench.kernel.call_at(cycle * TICKS - 1, lambda c=cycle: seen.append((c, bench.chip.status)), CPU)
    bench.kernel.run_until(100 * TICKS)
    assert (bench.chip.status, program.returned_at) == (0, 51)
    assert seen == [(12, 4), (13, 0)]


def test_what_was_posted_last_lands_before_the_program_is_over():
    bench = Bench([(5, 4, -1)])
    program = scripted(bench, work(10), Step(Op.STORE, STATUS, 4))
    bench.kernel.run_until(100 * TICKS)
    assert (bench.chip.status, program.returned_at) == (0, 13)


def test_memory_is_read_and_written_with_its_wait_states():
    """M0, L7 and the PIE's table: one wait state for reads of the last, and EALLOW for writes."""
    bench = Bench([])
    m0, l7 = 0x0010, 0xFFFE
    program = scripted(
        bench,
        Step(Op.STORE, m0, 0x1111),
        Step(Op.STORE, l7, 0x2222),
        Step(Op.STORE, SEQ1INT, 0x3333),
        *(Step(Op.LOAD, address) for address in (m0, l7, SEQ1INT)),
        Step(Op.LOAD_LONG, SEQ1INT + 1),
    )
    bench.kernel.run_until(100 * TICKS)
    assert program.seen == [(0x1111, 3), (0x2222, 4), (ROUTINE & 0xFFFF, 6), (ROUTINE, 8)]
    text = "0x0d40 of PIE vectors was written without EALLOW; the write is ignored"
    assert [(note.text, n) for note, n in bench.processor.notes.counts.items()] == [(text, 1)]
    bench.core.set_eallow(100, True)
    bench.processor.bus.write(100, SEQ1INT, 0x3333)
    assert bench.processor.bus.ram.word(SEQ1INT) == 0x3333


@pytest.mark.parametrize("address", [0x0E00, 0x7000, 0x1_0000, 0x3F_FFC0, -1])
def test_where_nothing_answers_is_told(address: int):
    with pytest.raises(NoSuchAddress):
        Bench([]).processor.bus.reads_at(0, address)


def test_an_access_that_acts_without_its_time_is_refused():
    bench = Bench([])
    with pytest.raises(RuntimeError, match=r"dsp: an access in cycle 7 has effects; call CpuTime\.meet before it"):
        bench.processor.bus.read(7, COUNT)


@pytest.mark.parametrize(("sp", "address"), [(0x0801, "0x0802"), (0x07F8, "0x0805")])
def test_a_stack_that_is_no_memory_ends_the_run(sp: int, address: str):
    bench = Bench([(100, 1, 0)])
    bench.enable()
    scripted(bench, work(50), *[work(1)] * 100)
    bench.core.sp = sp
    with pytest.raises(FirmwareError, match=rf"dsp: SP = {sp:#x} at cycle 104; {address} is not memory"):
        bench.kernel.run_until(400 * TICKS)


def test_a_vector_without_a_name_is_told_by_its_line():
    """Line 1.3 belongs to no module; firmware that sets its flag by itself takes it."""
    recorder, found = recorder_of(Kind.IRQ)
    bench = Bench([], recorder=recorder)
    bench.enable()
    program = scripted(bench, work(50), *[work(1)] * 100)
    bench.processor.bus.ram.put_word32(0x0D44, ROUTINE)
    bench.pie.write(0, 0x2, 4)
    bench.kernel.call_at(60 * TICKS, lambda: (bench.pie.request(60, 1, 3), bench.pie_socket.publish(60)))
    bench.kernel.run_until(400 * TICKS)
    assert [(r.what, r.value) for r in found] == [("INT1.3", 1), ("INT1.3", 0)] and program.finished


def test_a_processor_without_a_program_says_so():
    processor = Bench([]).processor
    with pytest.raises(RuntimeError, match=r"dsp has no program; give it one with Processor\.start"):
        processor.program  # noqa: B018
    processor.kill()
    assert processor.causing_statement() is None


def test_a_program_that_is_none_says_what_is_missing():
    class Nothing(Program):
        pass

    for call in (lambda p: p.run(), lambda p: p.place(), lambda p: p.enter(0)):
        with pytest.raises(NotImplementedError):
            call(Nothing())
