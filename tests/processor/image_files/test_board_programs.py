"""Programs on boards: they show without public images what those show on the same boards."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Mapping
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.processor.image_files.assemble import SHIPPED
from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene
from tests.processor.image_files.board_programs import CLOCK, ECHO, KEYPAD, LINKED, RS485, SENDER
from tests.scene.small import case

TXRDY, TXEMPTY = 7, 6  # bits of SCICTL2
PASSES_OF_10_MS = 300_000


class Board:
    """A case whose unit runs a program, with its records, its result and the bytes that it sent."""

    def __init__(self, program: Path, seconds: str, unit: Mapping[str, Any], kinds: Iterable[Kind], **tables: Any):
        self.records: list[Record] = []
        tables["unit"] = {"dsp": {"image": str(program), **unit}}
        wanted = {*kinds, Kind.FRAME}
        self.scene = Scene(case(**tables), lambda recorder, _: recorder.subscribe(wanted, self.records.append))
        self.result: Result = self.scene.run(Fraction(seconds))

    def sent(self, wire: str) -> bytes:
        return bytes(one.value & 0xFF for one in self.records if (one.where, one.what) == (wire, "end"))


def program(folder: Path, source: str) -> Path:
    path = folder / "program.asm"
    path.write_text(source)
    return path


@pytest.mark.parametrize(("last_wait", "cuts"), [(TXEMPTY, 0), (TXRDY, 1)])
def test_an_rs485_driver_is_enabled_while_the_image_sends_and_disabling_it_early_is_noted(
    tmp_path: Path, last_wait: int, cuts: int
):
    """SCI-B uses pins that the program selects. TXRDY only says that the last character is in the shift register."""
    unit = {"modules": ["SCI-B", "GPIO"], "pins": {"DE": 49, "SCI-B.TX": 22, "SCI-B.RX": 23}}
    budgets = [{"name": "cut", "measure": "count of frame RS485 cut", "max": 0}]
    tables = {"transceiver": [{"on": "dsp.SCI-B", "de": "DE"}], "budget": budgets}
    source = RS485.replace("LAST_WAIT", str(last_wait))
    board = Board(program(tmp_path, source), "0.006", unit, [Kind.EDGE], **tables)
    assert board.sent("SCI-B.TX") == b"moto"
    enable = [one.tick for one in board.records if one.kind is Kind.EDGE and one.where == "DE"][-2:]
    frames = [one.tick for one in board.records if one.where == "SCI-B.TX" and one.what in ("begin", "end")]
    assert enable[0] < frames[0]
    assert (enable[1] >= frames[-1]) == (cuts == 0)
    assert [verdict.passed for verdict in board.result.budgets] == [cuts == 0]
    assert [note for note in board.result.notes if "before its frame is over" in note] == [
        f"RS485: DE switches the driver of dsp.SCI-B off before its frame is over, first at {at} (1 time)"
        for at in [board.scene.timebase.show(enable[1])][:cuts]
    ]


def test_an_echo_by_a_timer_interrupt_keeps_the_fpu_registers_of_main(tmp_path: Path):
    unit = {"modules": ["SCI-A", "GPIO", "TIMER0"], "pins": {"TX": 35, "RX": 36}}
    send = [{"name": "hi", "to": "dsp.SCI-A", "text": "hi", "at": "5 ms", "gap": "1 ms"}]
    board = Board(program(tmp_path, ECHO), "0.0135", unit, [Kind.IRQ], serial={"baud": 4800, "send": send})
    assert board.sent("TX") == b"hi"
    taken = [one.tick for one in board.records if one.kind is Kind.IRQ and one.what == "TINT0" and one.value]
    assert len(taken) == 18
    per_us = board.scene.timebase.per_second / 1_000_000
    assert all(abs((after - before) / per_us - 500) < 0.1 for before, after in pairwise(taken))
    cpu = board.scene.units["dsp"].program.cpu  # type: ignore[attr-defined]
    counted, one = struct.unpack("<2f", struct.pack("<2I", *(number & 0xFFFF_FFFF for number in cpu.r[:2])))
    assert (
        one == 1.0 and counted == int(counted) > 100_000
    )  # the routine's values of these registers were replaced by the saved ones


def test_pins_without_a_wire_are_noted_with_the_keys_to_add(tmp_path: Path):
    board = Board(program(tmp_path, ECHO), "0.005", {"modules": ["SCI-A", "GPIO", "TIMER0"]}, [])
    [note] = [note for note in board.result.notes if "SCI-A" in note]
    assert note == (
        "dsp: SCI-A has RX on GPIO36 and TX on GPIO35, where the case has no wire; "
        "add pins = { RX = 36, TX = 35 } to the unit"
    )
    unit = {"modules": ["SCI-B", "GPIO"], "pins": {"SCI-B.TX": 22}}
    board = Board(program(tmp_path, RS485.replace("LAST_WAIT", "6")), "0.005", unit, [])
    [note] = [note for note in board.result.notes if "SCI-B" in note]
    assert 'SCI-B has RX on GPIO23, where the case has no wire; add pins = { "SCI-B.RX" = 23 }' in note


def test_a_sender_sends_every_10_ms_up_to_the_phase_of_its_bit_clock(tmp_path: Path):
    """A pass of the wait takes 5 cycles; a frame begins at the SCI's next clock edge, eight of which are a bit."""
    unit = {"modules": ["SCI-A", "GPIO"], "pins": {"TX": 29, "RX": 28}}
    source = SENDER.replace("PASSES", str(PASSES_OF_10_MS))
    board = Board(program(tmp_path, source), "0.0155", unit, [Kind.ACCESS], serial={"baud": 9600})
    assert board.sent("TX") == b"ss"
    cycle = board.scene.timebase.per_second // 150_000_000
    written = [one.tick for one in board.records if one.what == "W SCI-A.SCITXBUF"]
    assert written[1] - written[0] == ((PASSES_OF_10_MS + 1) * 5 + 16) * cycle
    begun = [one.tick for one in board.records if (one.where, one.what) == ("TX", "begin")]
    waits = [begins - writes for begins, writes in zip(begun, written, strict=True)]
    assert all(0 < wait <= 4 * 488 * cycle for wait in waits) and waits[0] != waits[1]


def test_a_clock_is_set_byte_by_byte_and_read_back_by_interrupts(tmp_path: Path):
    """Each STOP interrupts, and so does ARDY after the pointer, before the repeated START."""
    unit = {"modules": ["I2C-A", "GPIO"]}
    board = Board(program(tmp_path, CLOCK), "0.0125", unit, [Kind.IRQ], device={"clock": {"model": "isl12026"}})
    dsp = board.scene.units["dsp"]
    got = [dsp.processor.bus.ram.word(0x8040 + at) for at in range(8)]
    assert bytes(got).hex(" ") == "50 39 95 01 03 12 06 20"
    taken = [one.what for one in board.records if one.kind is Kind.IRQ and one.value]
    assert taken == ["I2CINT1A"] * 12  # the STOPs of ten writes and of the read, and ARDY
    assert dsp.program.finished and board.scene.devices["clock"].log.notes == {}


@pytest.mark.parametrize(("key", "answer"), [([], b"u"), ([{"from": "dsp.GPIO25", "to": "dsp.GPIO20"}], b"d")])
def test_a_pressed_key_is_a_cable_from_its_column_to_its_row(tmp_path: Path, key: list[dict[str, str]], answer: bytes):
    """The program sends on SCI-C which level it has read."""
    unit = {"modules": ["SCI-C", "GPIO"], "pins": {} if key else {"ROW": 20}}
    board = Board(program(tmp_path, KEYPAD), "0.0046", unit, [], cable=key)
    assert board.sent("SCI-C.TX") == answer
    assert [note for note in board.result.notes if "ESTOP0" not in note] == []


BUILDS = {
    "flash": {"start": "0x33FFF6", "text": "0x330000", "loaded": "0x331000"},
    "ram": {"start": "0", "text": "0x9000", "loaded": "0xA000"},
}


def test_one_program_linked_to_flash_and_to_ram_makes_the_same_writes_in_the_same_order(tmp_path: Path):
    """In flash the program is slower; its function is copied to RAM and runs there."""
    came = {}
    for boot, where in BUILDS.items():
        source = LINKED.format(**where, ramfuncs="0x8000")
        board = Board(
            program(tmp_path, source), "0.006", {"boot": boot, "modules": ["SCI-A", "GPIO"]}, [Kind.ACCESS, Kind.SPAN]
        )
        dsp = board.scene.units["dsp"]
        assert dsp.program.finished
        writes = [(one.what, one.value) for one in board.records if one.what.startswith("W ")]
        came[boot] = writes, dsp.program.returned_at
    assert came["flash"][0] == came["ram"][0] and len(came["ram"][0]) > 12
    assert came["flash"][0][-1] == ("W GPIO.GPATOGGLE", 8 << 16)
    assert came["flash"][1] > came["ram"][1] + 100


def test_an_image_that_never_writes_pieack_may_get_no_interrupt(tmp_path: Path):
    """`pieack_reset`: if all groups wait for an acknowledge, the slave never sends its first byte."""
    slave = (SHIPPED / "register_slave.asm").read_text(encoding="utf-8")
    request = [{"name": "read", "address": 0x50, "pointer": 1, "count": 2, "expect": "11 12"}]
    tables = {
        "controller": {"first": "5 ms", "period": "10 ms", "request": request},
        "budget": [{"name": "wrong bytes", "measure": "wrong bytes", "max": 0}],
    }
    for acknowledges, reset, serves in ((True, 0xFFF, True), (False, 0, True), (False, 0xFFF, False)):
        source = slave if acknowledges else slave.replace("          MOV   @PIEACK,#0xFFF\n", "")
        assert (source == slave) == acknowledges
        unit = {"modules": ["I2C-A", "GPIO"], "options": {"system": {"pieack_reset": reset}}}
        board = Board(program(tmp_path, source), "0.009", unit, [Kind.IRQ], **tables)
        assert [one.passed for one in board.result.budgets] == [serves]
        assert bool([one for one in board.records if one.kind is Kind.IRQ]) == serves
