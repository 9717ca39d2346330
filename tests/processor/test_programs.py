"""Programs other than Python firmware have the same service of time, bus and interrupts as firmware."""

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
MAIN, ROUTINE = 0x9000, 0x30_A000  # code addresses: one in L1, and one that needs all 22 bits
STATUS, COUNT, PIEACK, SEQ1INT = 0x7100, 0x7101, 0x0CE1, 0x0D40


def work(cycles: int) -> Step:
    return Step(Op.WORK, 0, cycles)


def scripted(bench: Bench, *main: Step, routine: tuple[Step, ...] = ()) -> ScriptedProgram:
    """Start a program on the bench; the vector of SEQ1INT is stored as its start-up code would store it."""
    code = {MAIN: list(main), ROUTINE: [*routine, Step(Op.STORE, PIEACK, 1), Step(Op.IRET)]}
    program = ScriptedProgram(bench.processor, code, MAIN)
    bench.processor.bus.ram.put_word32(SEQ1INT, ROUTINE)
    bench.processor.start(program)
    return program


def bare(records: list[Record]) -> list[tuple[Any, ...]]:
    """Return records without their place in the source, which only Python firmware has."""
    return [(r.tick, r.kind, r.where, r.what, r.value, r.cause) for r in records]


def test_an_interrupt_uses_the_vector_table_and_the_stack_in_memory():
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
    back_to = MAIN + 2 + 4  # the address of the next step
    assert inside == [(["0x1234", "0xbeef", hex(st1), "0x1", hex(back_to), "0x0"], 0x421 + 15, 0)]
    assert (program.al, program.st0, bench.core.sp, bench.core.ier) == (0xBEEF, 0x1234, 0x421, 1)
    assert program.seen == [(1, 115 + 2)]  # two wait states of frame 2
    #         SET and 139 cycles, entry, SET, load, store of PIEACK, IRET
    assert program.returned_at == 140 + 10 + 1 + 3 + 1 + 8
    assert program.finished


def test_a_program_runs_until_the_next_event_of_another_party():
    """An event of another party at 50 changes the value that a load at 52 reads, and not that of a load at 49."""
    bench = Bench([(50, 3, -1)])
    program = scripted(bench, work(47), Step(Op.LOAD, STATUS), Step(Op.LOAD, STATUS))
    bench.kernel.run_until(200 * TICKS)
    assert program.seen == [(0, 49), (3, 52)]
    assert program.runs[0] == 49  # it may run until just before 50; the first load ends at 50


def test_an_interrupt_within_a_step_is_taken_at_its_end():
    bench = Bench([(100, 1, 0)])
    bench.enable()
    program = scripted(bench, work(130), work(10))
    bench.kernel.run_until(400 * TICKS)
    assert program.entered == [(ROUTINE, 130 + 10)]


def test_a_routine_may_return_to_another_place_than_the_interrupted_one():
    """The routine sets the stack pointer to a frame that it wrote; the program continues where that frame says."""
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
def test_a_program_makes_the_same_records_as_equivalent_python_firmware(steps: int):
    """Loads with side effects, posted writes and an interrupt have records of equal order, ticks and causes."""
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


def test_a_program_and_python_firmware_read_the_same_module():
    """A read clears COUNT: the first read in the order of cycles gets the count, whichever program is run first."""
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


def test_a_posted_write_lands_within_later_work():
    """A write posted in cycle 10 takes effect at the end of cycle 12, within 40 cycles of work."""
    bench = Bench([(5, 4, -1)])
    program = scripted(bench, work(10), Step(Op.STORE, STATUS, 4), work(40))
    seen: list[tuple[int, int]] = []
    for cycle in (12, 13):
        bench.kernel.call_at(cycle * TICKS - 1, lambda c=cycle: seen.append((c, bench.chip.status)), CPU)
    bench.kernel.run_until(100 * TICKS)
    assert (bench.chip.status, program.returned_at) == (0, 51)
    assert seen == [(12, 4), (13, 0)]


def test_the_last_posted_write_lands_before_the_program_has_ended():
    bench = Bench([(5, 4, -1)])
    program = scripted(bench, work(10), Step(Op.STORE, STATUS, 4))
    bench.kernel.run_until(100 * TICKS)
    assert (bench.chip.status, program.returned_at) == (0, 13)


def test_memory_is_read_and_written_with_its_wait_states():
    """M0, L7 and the PIE vector table, whose reads have a wait state and whose writes need EALLOW."""
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
def test_an_address_without_memory_or_register_is_refused(address: int):
    with pytest.raises(NoSuchAddress):
        Bench([]).processor.bus.reads_at(0, address)


def test_an_access_with_effects_at_another_time_is_refused():
    bench = Bench([])
    with pytest.raises(RuntimeError, match=r"dsp: an access in cycle 7 has effects; call CpuTime\.meet before it"):
        bench.processor.bus.read(7, COUNT)


@pytest.mark.parametrize(("sp", "address"), [(0x0801, "0x0802"), (0x07F8, "0x0805")])
def test_a_stack_pointer_outside_memory_ends_the_run(sp: int, address: str):
    bench = Bench([(100, 1, 0)])
    bench.enable()
    scripted(bench, work(50), *[work(1)] * 100)
    bench.core.sp = sp
    with pytest.raises(FirmwareError, match=rf"dsp: SP = {sp:#x} at cycle 104; {address} is not memory"):
        bench.kernel.run_until(400 * TICKS)


def test_an_interrupt_without_a_name_is_recorded_with_its_group_and_line():
    """Line 1.3 belongs to no module; its flag is set directly."""
    recorder, found = recorder_of(Kind.IRQ)
    bench = Bench([], recorder=recorder)
    bench.enable()
    program = scripted(bench, work(50), *[work(1)] * 100)
    bench.processor.bus.ram.put_word32(0x0D44, ROUTINE)
    bench.pie.write(0, 0x2, 4)
    bench.kernel.call_at(60 * TICKS, lambda: (bench.pie.request(60, 1, 3), bench.pie_socket.publish(60)))
    bench.kernel.run_until(400 * TICKS)
    assert [(r.what, r.value) for r in found] == [("INT1.3", 1), ("INT1.3", 0)] and program.finished


def test_a_processor_without_a_program_raises_an_error():
    processor = Bench([]).processor
    with pytest.raises(RuntimeError, match=r"dsp has no program; give it one with Processor\.start"):
        processor.program  # noqa: B018
    processor.kill()
    assert processor.causing_statement() is None


def test_methods_that_a_program_must_define_are_not_implemented():
    class Nothing(Program):
        pass

    for call in (lambda p: p.run(), lambda p: p.place(), lambda p: p.enter(0)):
        with pytest.raises(NotImplementedError):
            call(Nothing())
