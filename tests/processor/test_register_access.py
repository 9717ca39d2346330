"""Cycles and instants of register accesses: wait states, write-to-read protection, EALLOW, bit-field writes."""

from __future__ import annotations

import sys

import pytest

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.registers import Register
from periph_sim.core.time import Timebase
from periph_sim.core.wire import Wire
from periph_sim.f28335.cpu.code_costs import BARE
from periph_sim.f28335.descriptor import Frame
from periph_sim.f28335.memory.memory_map import ModuleRange, NoSuchAddress
from periph_sim.f28335.system_options import SystemOptions
from periph_sim.processor.dsp import Dsp, DspPlan
from periph_sim.processor.python import register_view
from periph_sim.processor.python.cpu import Cpu
from periph_sim.processor.user_code import FirmwareError
from tests.processor.bench import Bench, unit


def cost_and_options_of(
    frame: Frame, access: str, options: SystemOptions | None = None, times: int = 1, base: int = 0x3000
) -> tuple[int, set[str]]:
    """Return the cycles of `times` consecutive accesses outside of the protected block, and the options used."""
    bench = Bench([], frame=frame, options=options, base=base)

    def main() -> None:
        for _ in range(times):
            if access == "read":
                _ = bench.flags.STATUS.all
            else:
                bench.flags.STATUS.all = 0
        bench.note("end")

    return bench.run(main, 1000)[0][1], bench.core.touched


@pytest.mark.rule("SYS-034", "SYS-035", "SYS-037", "I2C-006")
@pytest.mark.parametrize(("frame", "read", "write"), [(Frame.PF0, 2, 1), (Frame.PF1, 3, 1), (Frame.PF2, 3, 1)])
def test_an_access_takes_one_cycle_and_the_wait_states_of_its_frame(frame, read, write):
    assert cost_and_options_of(frame, "read")[0] == read
    assert cost_and_options_of(frame, "write")[0] == write


@pytest.mark.rule("SYS-037")
@pytest.mark.parametrize("wait_states", [0, 2, 5])
def test_open_pf2_read_ws(wait_states):
    cost, listed = cost_and_options_of(Frame.PF2, "read", SystemOptions(pf2_read_ws=wait_states))
    assert (cost, listed) == (1 + wait_states, {"pf2_read_ws"})


@pytest.mark.parametrize("wait_states", [0, 1])
def test_open_pf2_write_ws(wait_states):
    cost, listed = cost_and_options_of(Frame.PF2, "write", SystemOptions(pf2_write_ws=wait_states))
    assert cost == 1 + wait_states and listed >= {"pf2_write_ws", "write_lands"}


@pytest.mark.rule("SYS-036")
@pytest.mark.parametrize("extra", [1, 0])
def test_open_pf1_back_to_back_write(extra):
    options = SystemOptions(pf1_back_to_back_write=extra)
    cost, listed = cost_and_options_of(Frame.PF1, "write", options, times=3)
    assert (cost, listed) == (3 + 2 * extra, {"pf1_back_to_back_write", "write_lands"})
    assert cost_and_options_of(Frame.PF1, "write", options) == (1, {"write_lands"})
    assert cost_and_options_of(Frame.PF2, "write", options, times=3)[0] == 3


@pytest.mark.rule("SYS-036")
def test_an_instruction_between_two_pf1_writes_hides_the_extra_cycle():
    bench = Bench([], frame=Frame.PF1)

    def main() -> None:
        bench.flags.STATUS.all = 0
        bench.cpu.nop()
        bench.flags.STATUS.all = 0
        bench.note("end")

    assert bench.run(main, 100) == [("end", 3)]


@pytest.mark.rule("SYS-041")
@pytest.mark.parametrize(("between", "wait"), [(0, 3), (1, 2), (2, 1), (3, 0), (4, 0)])
def test_in_the_protected_block_a_read_waits_for_a_write(between, wait):
    bench = Bench([], base=0x7100)

    def main() -> None:
        bench.flags.STATUS.all = 0
        for _ in range(between):
            bench.cpu.nop()
        _ = bench.flags.STATUS.all
        bench.note("end")

    assert bench.run(main, 100) == [("end", 1 + between + wait + 3)]


@pytest.mark.rule("SYS-042", "SYS-044")
def test_outside_of_the_block_a_read_does_not_wait_for_a_write_inside():
    bench = Bench([], base=0x7100)

    def main() -> None:
        bench.flags.STATUS.all = 0
        _ = bench.pie_regs.PIECTRL.all  # frame 0, outside of the block: one wait state, no protection
        bench.note("end")

    assert bench.run(main, 100) == [("end", 1 + 2)]


@pytest.mark.rule("SYS-043")
def test_a_read_after_a_write_of_the_same_register_sees_the_write():
    bench = Bench([(1, 4, -1)])

    def main() -> None:
        bench.cpu.compute(10)
        bench.flags.STATUS.all = 4
        bench.note(f"C={bench.flags.STATUS.C}")

    assert bench.run(main, 100)[0][0] == "C=0"


@pytest.mark.rule("SYS-046", "SYS-019", "I2C-004", "I2C-010", "SYS-123")
def test_a_protected_write_has_an_effect_only_between_eallow_and_edis():
    dsp, kernel = unit("I2C-A")
    seen: list[int] = []

    def main() -> None:
        clocks, i2c, pie = dsp.module("SYS"), dsp.module("I2C-A"), dsp.module("PIE")
        clocks.PCLKCR0.all = 0x10
        seen.append(clocks.PCLKCR0.all)
        dsp.eallow()
        clocks.PCLKCR0.all = 0x10
        dsp.edis()
        seen.append(clocks.PCLKCR0.all)
        i2c.I2COAR.all = 0x68  # no EALLOW needed
        pie.PIEIER8.all = 0x3
        seen.extend((i2c.I2COAR.all, pie.PIEIER8.all))

    dsp.start(main)
    kernel.run_until(1_000_000)
    assert seen == [0, 0x10, 0x68, 0x3]
    assert [note.text for note in dsp.processor.notes.counts] == [
        "PCLKCR0 of SYS was written without EALLOW; the write is ignored"
    ]


@pytest.mark.parametrize(("set_at", "lost"), [(1, True), (2, True), (3, False), (4, False), (5, False)])
def test_a_flag_set_between_read_and_write_is_kept_by_the_write_back(set_at, lost):
    """C is write-1-to-clear. A write of field A first reads C: if C is set by then, writing it back clears it."""
    bench = Bench([(set_at, 4, -1)])

    def main() -> None:
        bench.flags.STATUS.A = 0  # a read-modify-write meant for another field
        bench.cpu.compute(20)
        bench.note(f"C={bench.flags.STATUS.C}")

    assert bench.run(main, 100)[0][0] == f"C={0 if lost else 1}"


def test_unknown_names_and_addresses_are_refused_with_suggestions():
    bench = Bench([])
    with pytest.raises(AttributeError, match=r"FLAGS has no register 'STATSU'; did you mean STATUS\?"):
        _ = bench.flags.STATSU
    with pytest.raises(AttributeError, match=r"FLAGS has no register 'STATSU'; did you mean STATUS\?"):
        bench.flags.STATSU = 1
    with pytest.raises(AttributeError, match=r"FLAGS\.STATUS is a register; write STATUS\.all = "):
        bench.flags.STATUS = 1
    with pytest.raises(AttributeError, match=r"FLAGS\.STATUS has no field 'D'; it has A, B, C"):
        bench.flags.STATUS.D = 1
    with pytest.raises(NoSuchAddress, match=r"0x7200 belongs to no module of this scene, which has FLAGS 0x7100, PIE"):
        raise bench.processor.bus.map.refusal(0x7200)
    found = bench.processor.bus.map.at(0x7101)
    assert found is not None
    assert (found[0].name, found[1].name, found[2]) == ("FLAGS", "COUNT", 0)


@pytest.mark.rule("I2C-005", "SYS-040")
def test_a_register_port_is_made_once_when_firmware_first_uses_it(monkeypatch: pytest.MonkeyPatch):
    """A unit has a hundred registers with a class each; making all of them took most of the set-up of a small scene."""
    made: list[str] = []
    make = register_view.register_port

    def counted(cpu: Cpu, place: ModuleRange, register: Register) -> register_view.RegisterPort:
        made.append(register.name)
        return make(cpu, place, register)

    monkeypatch.setattr(register_view, "register_port", counted)
    flags = Bench([]).flags
    assert made == []
    assert flags.STATUS is flags.STATUS is flags["STATUS"] and flags["COUNT"] is flags.COUNT
    assert made == ["STATUS", "COUNT"]


def test_frame_2_ignores_32_bit_accesses():
    bench = Bench([(1, 4, -1)], base=0x7100)
    bench.run(
        lambda: (bench.cpu.store(0x7100, 0xFFFF_FFFF, width=32), bench.note(f"{bench.cpu.load(0x7100, 32)}")), 100
    )
    assert bench.log == [("0", 6)]  # nothing was read, and each access took the time of a read
    assert bench.chip.status == 4  # nothing was written: C, which writing 1 clears, is still set
    (note,) = bench.processor.notes.counts
    assert note.text == "STATUS of FLAGS was accessed with 32 bits; peripheral frame 2 takes 16 only"


def test_an_address_reads_and_writes_its_register():
    bench = Bench([(1, 4, -1)], base=0x7100)
    bench.run(lambda: (bench.cpu.compute(9), bench.cpu.store(0x7100, 4), bench.note(f"{bench.cpu.load(0x7100)}")), 100)
    assert bench.log[0][0] == "0"


class Board:
    """A unit with GPIO and a timer, with pins driven from outside and registers read as by a debugger."""

    def __init__(self, **wires: int) -> None:
        kernel, recorder = Kernel(), Recorder()
        self.accesses: list[Record] = []
        recorder.subscribe([Kind.ACCESS], self.accesses.append)
        self.pads = {pin: Wire(kernel, name, recorder) for name, pin in wires.items()}
        self.hands = {pin: wire.attach("hand") for pin, wire in self.pads.items()}
        self.dsp = Dsp(kernel, Timebase(150_000_000), recorder, DspPlan("dsp", ("GPIO", "TIMER0"), self.pads))
        self.kernel = kernel

    def run(self, firmware) -> None:
        self.dsp.start(firmware)
        self.kernel.run_until(self.kernel.now + 1_000_000)

    def shows(self, module: str, register: str) -> int:
        chip = self.dsp.sockets[module].chip
        cycle = self.dsp.clock.cycle_at(self.kernel.now)
        return chip.peek(cycle, chip.MAP[register].offset)


def test_32_bit_write_of_a_pair_of_16_bit_registers_reaches_both():
    """PRD.all = 30_000_000 of TI's header is one 32-bit store to PRD and PRDH."""
    board = Board()
    timer = board.dsp.module("TIMER0")
    seen: list[int] = []

    def main() -> None:
        timer.PRD.all = 30_000_000
        seen.append(timer.PRD.all)

    board.run(main)
    assert (board.shows("TIMER0", "PRD"), board.shows("TIMER0", "PRDH")) == (30_000_000 & 0xFFFF, 30_000_000 >> 16)
    assert seen == [30_000_000]
    assert [(a.what, a.value) for a in board.accesses] == [
        ("W TIMER0.PRD", 30_000_000),
        ("R TIMER0.PRD", 30_000_000),
    ]


def test_halves_of_a_pair_are_written_and_read_separately():
    board = Board()
    timer = board.dsp.module("TIMER0")
    seen: list[int] = []

    def main() -> None:
        timer.PRD.all = 0x1111_2222
        timer.PRD.half.MSW = 0x3333
        seen.extend((timer.PRD.half.LSW, timer.PRD.half.MSW, timer.PRDH.all))
        timer.PRD.half.LSW = 0x4444
        timer.PRD.PRD = 0x5555  # the field of the manual's 16-bit register

    board.run(main)
    assert seen == [0x2222, 0x3333, 0x3333]
    assert (board.shows("TIMER0", "PRD"), board.shows("TIMER0", "PRDH")) == (0x5555, 0x3333)


@pytest.mark.parametrize("address", [0x0C02, 0x0C03])
def test_32_bit_access_by_address_begins_at_the_even_word(address):
    board = Board()
    seen: list[int] = []

    def main() -> None:
        board.dsp.cpu.store(address, 0x0123_4567, width=32)
        seen.append(board.dsp.cpu.load(address, 32))

    board.run(main)
    assert seen == [0x0123_4567]
    assert (board.shows("TIMER0", "PRD"), board.shows("TIMER0", "PRDH")) == (0x4567, 0x0123)


def test_32_bit_load_of_two_pie_registers_reads_both():
    bench = Bench([])
    bench.pie.write(0, 0x2, 0x12)  # PIEIER1
    bench.pie.request(0, 1, 3)  # PIEIFR1
    bench.run(lambda: bench.note(f"{bench.cpu.load(0x0CE2, 32):#x}"), 100)
    assert bench.log[0][0] == "0x40012"


@pytest.mark.rule("SYS-057", "SYS-059")
@pytest.mark.parametrize(("how", "pad", "level"), [("store", 20, 1), ("field", 20, 1), ("field", 4, 0)])
def test_a_write_of_half_a_port_copies_only_the_pads_of_that_half(how: str, pad: int, level: int):
    """The latch is 1 and the pad is held low from outside: bit-banging on GPIO5 copies GPIO4's pad, not GPIO20's."""
    board = Board(LOW=pad)
    gpio = board.dsp.module("GPIO")

    def main() -> None:
        gpio.GPASET.all = 1 << pad
        board.dsp.cpu.compute(10)
        if how == "store":
            board.dsp.cpu.store(0x6FC0, 1 << 5)
        else:
            gpio.GPADAT.GPIO5 = 1
        board.dsp.eallow()
        gpio.GPADIR.all = 1 << pad | 1 << 5
        board.dsp.edis()

    board.hands[pad].drive(0)
    board.run(main)
    board.hands[pad].drive(1)
    board.kernel.run_until(board.kernel.now + 1000)
    assert board.pads[pad].level == level  # nothing drives it from outside now, so it shows the latch


@pytest.mark.parametrize("strict", [True, False])
def test_a_noted_violation_ends_a_strict_run_with_its_line_and_time(strict):
    dsp, kernel = unit(strict=strict, code=BARE)
    lines: list[int] = []

    def main() -> None:
        dsp.cpu.compute(1498)
        lines.append(sys._getframe().f_lineno + 1)
        dsp.module("SYS").PCLKCR0.all = 0x10
        dsp.cpu.compute(10)

    dsp.start(main)
    note_text = "PCLKCR0 of SYS was written without EALLOW; the write is ignored"
    if strict:
        with pytest.raises(FirmwareError) as error:
            kernel.run_until(20 * 5000)
        place = f"line {lines[0]} of test_register_access.py"
        assert str(error.value) == f"dsp, {place}, at 9.987 us: {note_text} [SPRUFB0D section 7.2]"
    else:
        kernel.run_until(20 * 5000)
        assert [(note.text, count) for note, count in dsp.processor.notes.counts.items()] == [(note_text, 1)]
