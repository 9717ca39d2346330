"""Words of frames without a model: the first access looks up the properties of a word, later ones do not."""

from __future__ import annotations

from collections import Counter

import pytest

from periph_sim.f28335.memory.memory_map import AddressMap
from periph_sim.processor.image import elsewhere
from periph_sim.processor.user_code import FirmwareLost
from tests.processor.image.rig import HEAD, Rig

ZONE_0 = 0x4000  # address of the first word of XINTF zone 0
LOOP = """
 MOVW DP,#0x6800 >> 6
 MOVB XAR0,#49
loop: INC @0x6809
 MOVL ACC,@0x680A
 ADDB ACC,#2
 MOVL @0x680A,ACC
 BANZ loop,AR0--
 ESTOP0
"""  # 50 passes over two words of ePWM1


def test_a_loop_over_words_without_a_model_looks_each_of_them_up_once(monkeypatch: pytest.MonkeyPatch):
    found, looked = Counter[int](), Counter[int]()
    at, area_at = AddressMap.at, elsewhere.area_at
    monkeypatch.setattr(AddressMap, "at", lambda memory, address: (found.update([address]), at(memory, address))[1])
    monkeypatch.setattr(AddressMap, "refusal", None)
    monkeypatch.setattr(elsewhere, "area_at", lambda address: (looked.update([address]), area_at(address))[1])
    rig = Rig(HEAD + LOOP).run()
    assert rig.program.returned_at is not None
    assert rig.cpu.acc == 100
    assert rig.cpu.elsewhere.read(0, 0x6809) == 50
    assert found[0x6809] == 1 and found[0x680A] == 1
    assert (
        max(looked[address] for address in (0x6809, 0x680A, 0x680B)) <= 3
    )  # for its wait states, its read and its write


def test_each_write_of_a_protected_word_needs_eallow():
    """0x0B35 of XINTF is written with EALLOW, then twice without it, then with it again."""
    kept = " MOVW DP,#0x0B35 >> 6\n EALLOW\n MOV @0x0B35,#1\n EDIS\n"
    ignored = " MOV @0x0B35,#2\n MOV @0x0B35,#3\n MOV AL,@0x0B35\n"
    again = " EALLOW\n MOV @0x0B35,#4\n EDIS\n MOV AH,@0x0B35\n ESTOP0"
    rig = Rig(HEAD + kept + ignored + again).run()
    assert rig.cpu.acc == 0x0004_0001
    counts = rig.dsp.processor.notes.counts
    assert [(note.text, count) for note, count in counts.items() if "EALLOW" in note.text] == [
        ("XINTF + 0x15 was written without EALLOW; the write is ignored", 2)
    ]


def test_a_flash_command_is_refused_although_its_word_was_read_before():
    read = " MOVW DP,#0x0A90 >> 6\n MOV AL,@0x0A90\n MOV AL,@0x0A90\n EALLOW\n MOV @0x0A90,#1\n ESTOP0"
    with pytest.raises(FirmwareLost, match=r"flash control \+ 0x10 is written: erasing and programming flash"):
        Rig(HEAD + read).run()


def test_a_stub_replaces_a_word_that_was_read_and_written_before():
    rig = Rig(HEAD + LOOP).run()
    assert rig.cpu.elsewhere.read(0, 0x6809) == 50
    rig.cpu.elsewhere.answer(0x6809, 7)
    assert rig.cpu.elsewhere.read(0, 0x6809) == 7
    rig.cpu.elsewhere.write(0, 0x6809, 8)
    assert rig.cpu.elsewhere.read(0, 0x6809) == 7


def test_each_write_of_the_wait_states_of_flash_takes_effect():
    writes = "".join(f" MOV @0x0A86,#{waits:#06x}\n" for waits in (0x0505, 0x0304))
    rig = Rig(f"{HEAD} MOVW DP,#0x0A86 >> 6\n EALLOW\n{writes} ESTOP0").run()
    assert rig.cpu.elsewhere.fetches(0x33_0000) == (1, 4, 3)


def test_a_reset_clears_registers_of_frames_and_keeps_zone_0():
    """Registers: the flash's wait states and its prefetch, TBCTL of ePWM1 (0x6800); and a word of XINTF zone 0.

    The first pass stores what it reads at 0x9101, writes, and resets the unit by WDCHK = 0; the second pass ends.
    """
    reads = "".join(
        f" MOVW DP,#{address:#x} >> 6\n MOV AL,@{address:#x}\n MOV *XAR4++,AL\n"
        for address in (0x0A86, 0x0A80, 0x6800, 0x4000)
    )
    writes = "".join(
        f" MOVW DP,#{address:#x} >> 6\n MOV @{address:#x},#{value:#x}\n"
        for address, value in ((0x0A86, 0x0503), (0x0A80, 1), (0x6800, 7), (0x4000, 8))
    )
    head = HEAD.replace("#0x68", "#0x28") + " MOVW DP,#COUNT >> 6\n INC @COUNT\n MOVL XAR4,#0x9101\n"
    last = " MOVW DP,#COUNT >> 6\n CMP @COUNT,#2\n SB last,EQ\n EALLOW\n"
    rig = Rig(f"{head}{reads}{last}{writes} MOVW DP,#WDCR >> 6\n MOV @WDCR,#0\nloop: SB loop,UNC\nlast: ESTOP0").run()
    assert rig.program.finished and rig.dsp.resets == 1
    assert [rig.word(0x9101 + n) for n in range(4)] == [0x0F0F, 0, 0, 8]
    assert rig.cpu.elsewhere.fetches(0x33_0000) == (1, 15, 15)


def test_the_normal_state_differs_after_the_first_access_to_a_word_that_clears_it():
    before, after = (Rig(HEAD + LOOP).cpu.elsewhere for _ in range(2))
    for each in (before, after):
        each.fill(ZONE_0, 0x8000)
    assert before.normal_state(0, 0) == after.normal_state(0, 0)
    assert after.write(0, ZONE_0, 0)
    assert before.normal_state(0, 0)["_frames"] != after.normal_state(0, 0)["_frames"]
