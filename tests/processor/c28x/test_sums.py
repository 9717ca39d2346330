"""Sums, copies and comparisons that the column `op` states, as a counting loop reads them."""

from __future__ import annotations

from periph_sim.processor.c28x.encodings import by_id, encodings
from periph_sim.processor.image.repeated_pass import Sum, sum_of

SUMS = {
    "ADDB_ACC_8", "ADDB_AX_8s", "ADDB_XARn_7", "ADDL_ACC_loc32", "ADDL_loc32_ACC", "ADDU_ACC_loc16", "ADD_AX_loc16",
    "ADD_loc16_16s", "ADD_loc16_AX", "BANZ_off16_ARndec", "DEC_loc16", "INC_loc16", "SUBB_ACC_8", "SUBB_XARn_7",
    "SUBL_ACC_loc32", "SUBL_loc32_ACC", "SUBU_ACC_loc16", "SUB_AX_loc16", "SUB_loc16_AX",
    "BAR_off16_ARn_ARm_EQ", "BAR_off16_ARn_ARm_NEQ", "CMPB_AX_8", "CMPL_ACC_loc32", "CMP_AX_loc16", "CMP_loc16_16s",
    "TEST_ACC", "MOVL_ACC_loc32", "MOVL_loc32_ACC", "MOVU_ACC_loc16", "MOVZ_AR6_loc16", "MOVZ_AR7_loc16",
    "MOVZ_ARn_loc16", "MOV_AX_loc16", "MOV_loc16_ARn", "MOV_loc16_AX",
    *(f"MOVL_XAR{n}_loc32" for n in range(8)), *(f"MOVL_loc32_XAR{n}" for n in range(8)),
}  # fmt: skip
SIDES = {
    "SUBL_loc32_ACC": Sum("loc", "loc", -1, "ACC"), "MOVZ_ARn_loc16": Sum("XARn", "loc", 0, ""),
    "BAR_off16_ARn_ARm_NEQ": Sum("", "ARn", -1, "ARm"), "TEST_ACC": Sum("", "ACC", -1, "0"),
}  # fmt: skip
NUMBERS = [("simm8", 0xFF, 0xFFFF), ("simm16", 0x8000, 0x8000), ("uimm8", 0xFF, 0xFF), ("1", 7, 1), ("loc", 7, None)]


def test_forms_that_are_a_sum_a_copy_or_a_comparison():
    assert {row.id for row in encodings() if sum_of(row) is not None} == SUMS
    assert {name: sum_of(by_id()[name]) for name in SIDES} == SIDES
    assert [Sum("AX", "AX", 1, right).number(c) for right, c, _ in NUMBERS] == [number for _, _, number in NUMBERS]
