"""Instructions that read an FPU result too early are found from the table; code of TI's compiler has none."""

from __future__ import annotations

import pytest

from periph_sim.processor.c28x.decoder import Instruction, sweep
from periph_sim.processor.c28x.delay_slots import late_results, not_kept, read_registers
from periph_sim.processor.image_files.assemble import assemble
from periph_sim.processor.image_files.load import load
from periph_sim.processor.image_files.model import Image
from tests.processor.image_files.public_images import public_image


def code_of(image: Image) -> tuple[list[Instruction], dict[int, int]]:
    """Return all instructions of an image, and the words of its code by address."""
    words = {section.run + at: word for section in image.code for at, word in enumerate(section.words)}
    found = [one for section in image.code for one in sweep(section.run, section.words)]
    return [one for one in found if isinstance(one, Instruction)], words


def violations(source: str) -> list[str]:
    instructions, words = code_of(assemble('.sect ".text", 0x9000\n_c_int00:\n' + source))
    return [text for one in instructions for text in not_kept(one, lambda address: words.get(address, 0))]


@pytest.mark.parametrize(
    ("source", "late", "read"),
    [
        ("ADDF32 R1H,R2H,R3H", "1", "23"),
        ("MPYF32 R1H,#2.0,R3H", "1", "3"),
        ("I32TOF32 R5H,*XAR4", "5", ""),
        ("EINVF32 R5H,R6H", "5", "6"),
        ("MPYF32 R1H,R2H,R3H || ADDF32 R4H,R5H,R6H", "14", "2356"),
        ("MPYF32 R1H,R2H,R3H || MOV32 R4H,*XAR4", "1", "23"),
        ("SUBF32 R1H,R2H,R3H || MOV32 *XAR4,R7H", "1", "237"),
        ("MACF32 R3H,R2H,R4H,R5H,R6H || MOV32 R7H,*XAR4", "34", "2356"),
        ("MACF32 R7H,R6H,R4H,R5H,R1H || MOV32 R0H,*XAR4", "47", "1567"),
        ("MACF32 R7H,R3H,*XAR6++,*XAR7++", "", "2367"),
        ("ABSF32 R1H,R2H", "", "2"),
        ("MAXF32 R1H,R2H || MOV32 R3H,R4H", "", "124"),
        ("SWAPF R1H,R2H", "", "12"),
        ("MOVIZ R1H,#0x4000", "", ""),
        ("MOV32 *XAR4,R6H", "", "6"),
        ("MOV32 @ACC,*(0:0x0F1A)", "", "2"),
        ("MOV32 @ACC,*(0:0x0F12)", "", "0"),
        ("MOV32 @ACC,*(0:0x0F2E)", "", "7"),
        ("MOV32 @ACC,*(0:0x0F32)", "", ""),
        ("MOV32 @ACC,*(0:0x0F00 + 0x40)", "", ""),
        ("SAVE RNDF32=1", "", "01234567"),
        ("ADDL ACC,P", "", ""),
    ],
)
def test_late_results_and_registers_read(source: str, late: str, read: str):
    (one, *_), _ = code_of(assemble(f'.sect ".text", 0x9000\n_c_int00: {source}\n'))
    registers = [mask & 0xFF for mask in (late_results(one), read_registers(one))]
    assert registers == [sum(1 << int(n) for n in some) for some in (late, read)]


def test_a_slot_is_one_instruction_long():
    assert violations(" MPYF32 R0H,R1H,R2H\n MOV32 R3H,R0H") == [
        "MOV32 at 0x009002 reads R0H in the delay slot of MPYF32 at 0x009000: the setting "
        "fpu_delay_slot selects whether it gets the new result"
    ]
    assert violations(" MPYF32 R0H,R1H,R2H\n NOP\n MOV32 R3H,R0H") == []
    assert violations(" MPYF32 R0H,R1H,R2H\n MOV32 R3H,R4H") == []


@pytest.mark.parametrize(
    ("reader", "found"),
    [
        ("MOV32 R3H,R4H,LV", 1),
        ("MOV32 R3H,R4H,EQ", 0),
        ("MOVST0 LVF", 1),
        ("MOVST0 ZF", 0),
        ("TESTTF LU", 1),
        ("TESTTF EQ", 0),
        ("MOV32 *SP++,STF", 1),
        ("NOP", 0),
    ],
)
def test_flags_of_a_result_are_as_late_as_the_result(reader: str, found: int):
    texts = violations(f" MPYF32 R0H,R1H,R2H\n {reader}")
    assert [text.split(" at ")[0] + text.split(" reads")[1][:12] for text in texts] == [
        f"{reader.split()[0]} LUF and LVF"
    ] * found
    assert violations(f" F32TOI16 R0H,R1H\n {reader}") == []


@pytest.mark.parametrize(("last", "found"), [(" ADDF32 R3H,R3H,R0H\nend: NOP", 1), (" NOP\nend: NOP", 0)])
def test_the_last_instruction_of_a_repeated_block_is_followed_by_its_first_one(last: str, found: int):
    source = " RPTB end,#1\n ADDF32 R4H,R3H,R1H\n" + " NOP\n" * 8 + last
    texts = violations(source)
    assert len(texts) == found
    assert not found or texts[0].startswith("ADDF32 at 0x009002 reads R3H in the delay slot of ADDF32 at ")


@pytest.mark.parametrize(("name", "late"), [("S12a", 1232), ("S1", 2)])
def test_code_of_tis_compiler_violates_no_delay_slot(name: str, late: int):
    instructions, words = code_of(load(public_image(name)))
    assert sum(late_results(one) != 0 for one in instructions) == late
    assert [text for one in instructions for text in not_kept(one, lambda address: words.get(address, 0))] == []
