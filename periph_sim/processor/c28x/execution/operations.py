"""Convert decoded instructions to operations, which are ready to execute.

Source: SPRU430F Table 5-1 and section 5.10 (forms with byte operands).
"""

# core: compiled

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache

from ..decoder import Instruction
from ..encodings import WIDE, Encoding
from ..pipeline import writes_at_once
from . import (
    accumulator,
    branches,
    control,
    fpu,
    fpu_moves,
    half_words,
    moves,
    multiply,
    shifts,
    stack,
)
from .cpu import READS, WRITES, Operation

# Ids of forms that encode one certain address register, such as MOVL_XAR6_22. The function for all address registers,
# MOVL_XARn_22 in this example, executes these forms.
OF_ONE_XAR = re.compile(r"((?:[A-Z]+|MOVL_loc32)_X?AR)(\d)(_[a-z0-9]+)?")
# For the id of a form without a function of its own: the name of the function that executes it, and the values of the
# fields that this function uses, but that the form does not have.
EXECUTED_BY: dict[str, tuple[str, dict[str, int]]] = {
    "ABORTI": ("SETC_bit", {"b": 1, "c": 1}),
    "ADD_ACC_loc16shT": ("ADD_ACC_16sh_0_15", {}),
    "ADD_ACC_loc16": ("ADD_ACC_16sh_0_15", {"s": 0}),
    "ADD_ACC_loc16sh_1_15": ("ADD_ACC_16sh_0_15", {}),
    "ADD_loc16_16s": ("ADD_loc16_AX", {}),
    "ADDB_ACC_8": ("ADD_ACC_16sh_0_15", {"s": 0}),
    "AND_ACC_16sh_16": ("AND_ACC_16sh_0_15", {"s": 16}),
    "AND_ACC_loc16": ("AND_ACC_16sh_0_15", {"s": 0}),
    "AND_loc16_16s": ("AND_loc16_AX", {}),
    "ANDB_AX_8": ("AND_AX_loc16", {}),
    "ASR_AX_T": ("ASR_AX_1_16", {}),
    "ASR64_ACC_P_T": ("ASR64_ACC_P_1_16", {}),
    "BF_off16_COND": ("B_off16_COND", {}),
    "CLRC_AMODE": ("SETC_bit", {"b": 8, "c": 0}),
    "SETC_M0M1MAP": ("SETC_bit", {"b": 11, "c": 1}),
    "SETC_OBJMODE": ("SETC_bit", {"b": 9, "c": 1}),
    "CLRC_XF": ("SETC_bit", {"b": 12, "c": 0}),
    "SETC_XF": ("SETC_bit", {"b": 12, "c": 1}),
    "CLRC_mode": ("SETC_mode", {"c": 0}),
    "SETC_mode": ("SETC_mode", {"c": 1}),
    "CMPB_AX_8": ("CMP_AX_loc16", {}),
    "DEC_loc16": ("ADD_loc16_AX", {"c": 0xFFFF}),
    "DMAC_ACC_P_loc32_indXAR7": ("DMAC_ACC_P_loc32_indXAR7inc", {"s": 0}),
    "DMAC_ACC_P_loc32_indXAR7inc": ("DMAC_ACC_P_loc32_indXAR7inc", {"s": 2}),
    "EALLOW": ("SETC_bit", {"b": 6, "c": 1}),
    "EDIS": ("SETC_bit", {"b": 6, "c": 0}),
    "ESTOP1": ("NOP_indind", {}),  # no emulator is connected
    "IACK_16": ("NOP_indind", {}),  # no modelled device reads the value on the data bus
    "IMACL_P_loc32_indXAR7": ("IMACL_P_loc32_indXAR7inc", {"s": 0}),
    "IMACL_P_loc32_indXAR7inc": ("IMACL_P_loc32_indXAR7inc", {"s": 2}),
    "IMPYSL_P_XT_loc32": ("IMPYAL_P_XT_loc32", {"b": 1}),
    "INC_loc16": ("ADD_loc16_AX", {"c": 1}),
    "INTR_NMI": ("TRAP_0_31", {"c": 18}),
    "INTR_EMUINT": ("TRAP_0_31", {"c": 17}),
    "LB_indXAR7": ("LB_22", {"n": 7}),
    "LC_indXAR7": ("LC_22", {"n": 7}),
    "LCR_indXARn": ("LCR_22", {}),
    "LOOPNZ_loc16_16": ("LOOPZ_loc16_16", {"b": 1}),
    "LOOPZ_loc16_16": ("LOOPZ_loc16_16", {"b": 0}),
    "LSL_ACC_T": ("LSL_ACC_1_16", {}),
    "LSL_AX_T": ("LSL_AX_1_16", {}),
    "LSL64_ACC_P_T": ("LSL64_ACC_P_1_16", {}),
    "LSR_AX_T": ("LSR_AX_1_16", {}),
    "LSR64_ACC_P_T": ("LSR64_ACC_P_1_16", {}),
    "MAC_P_loc16_indXAR7": ("MAC_P_loc16_indXAR7inc", {"s": 0}),
    "MAC_P_loc16_indXAR7inc": ("MAC_P_loc16_indXAR7inc", {"s": 1}),
    "MIN_AX_loc16": ("MAX_AX_loc16", {"b": 1}),
    "MINL_ACC_loc32": ("MAXL_ACC_loc32", {"b": 1}),
    "MOV_ACC_loc16shT": ("MOV_ACC_16sh_0_15", {}),
    "MOV_ACC_loc16": ("MOV_ACC_16sh_0_15", {"s": 0}),
    "MOV_ACC_loc16sh_1_15": ("MOV_ACC_16sh_0_15", {}),
    "MOV_ACC_loc16sh_16": ("MOV_ACC_16sh_0_15", {"s": 16}),
    "MOV_loc16_16": ("MOV_loc16_AX", {}),
    "MOV_loc16_0": ("MOV_loc16_AX", {"c": 0}),
    "MOV_loc16_ACCsh1": ("MOV_loc16_ACCsh2_8", {"s": 0}),
    "MOV_loc16_OVC": ("MOV_loc16_OVC", {"s": 10}),
    "MOV_OVC_loc16": ("MOV_OVC_loc16", {"s": 10}),
    "MOVB_ACC_8": ("MOV_ACC_16sh_0_15", {"s": 0}),
    "MOVB_AR6_8": ("MOV_ARn_loc16", {"n": 6}),
    "MOVB_AR7_8": ("MOV_ARn_loc16", {"n": 7}),
    "MOVB_AX_8": ("MOV_AX_loc16", {}),
    "MOVB_loc16_8_COND": ("MOV_loc16_AX_COND", {}),
    "MOVB_XARn_8": ("MOVL_XARn_22", {}),
    "MOVB_XAR6_8": ("MOVL_XARn_22", {"n": 6}),
    "MOVB_XAR7_8": ("MOVL_XARn_22", {"n": 7}),
    "MOVH_loc16_ACCsh1": ("MOVH_loc16_ACCsh2_8", {"s": 0}),
    "MOVS_T_loc16": ("MOVA_T_loc16", {"b": 1}),
    "MOVU_loc16_OVC": ("MOV_loc16_OVC", {"s": 0}),
    "MOVU_OVC_loc16": ("MOV_OVC_loc16", {"s": 0}),
    "MOVZ_ARn_loc16": ("MOVL_XARn_22", {}),
    "MOVZ_AR6_loc16": ("MOVL_XARn_22", {"n": 6}),
    "MOVZ_AR7_loc16": ("MOVL_XARn_22", {"n": 7}),
    "MOVZ_DP_10": ("MOVW_DP_16", {}),
    "MPYB_ACC_T_8": ("MPYXU_ACC_T_loc16", {}),
    "MPYB_P_T_8": ("MPYXU_P_T_loc16", {}),
    "MPYS_P_T_loc16": ("MPYA_P_T_loc16", {"b": 1}),
    "NORM_ACC_ind": ("NORM_ACC_ind", {"b": 0}),
    "NORM_ACC_indinc": ("NORM_ACC_ind", {"b": 1}),
    "NORM_ACC_inddec": ("NORM_ACC_ind", {"b": 2}),
    "NORM_ACC_ind0inc": ("NORM_ACC_ind", {"b": 3}),
    "NORM_ACC_ind0dec": ("NORM_ACC_ind", {"b": 4}),
    "NORM_ACC_XARninc": ("NORM_ACC_ind", {"b": 1}),
    "NORM_ACC_XARndec": ("NORM_ACC_ind", {"b": 2}),
    "OR_ACC_loc16": ("OR_ACC_16sh_0_15", {"s": 0}),
    "OR_ACC_16sh_16": ("OR_ACC_16sh_0_15", {"s": 16}),
    "OR_loc16_16": ("OR_loc16_AX", {}),
    "ORB_AX_8": ("OR_AX_loc16", {}),
    "OUT_ind_PA_loc16": ("IN_loc16_ind_PA", {}),
    "POP_AR1_AR0": ("POP_ARm_ARn", {"n": 0}),
    "POP_AR3_AR2": ("POP_ARm_ARn", {"n": 2}),
    "POP_AR5_AR4": ("POP_ARm_ARn", {"n": 4}),
    "PUSH_AR1_AR0": ("PUSH_ARm_ARn", {"n": 0}),
    "PUSH_AR3_AR2": ("PUSH_ARm_ARn", {"n": 2}),
    "PUSH_AR5_AR4": ("PUSH_ARm_ARn", {"n": 4}),
    "QMACL_P_loc32_indXAR7": ("QMACL_P_loc32_indXAR7inc", {"s": 0}),
    "QMACL_P_loc32_indXAR7inc": ("QMACL_P_loc32_indXAR7inc", {"s": 2}),
    "QMPYSL_P_XT_loc32": ("QMPYAL_P_XT_loc32", {"b": 1}),
    "RPT_loc16": ("RPT_8", {}),
    "SBF_off8_EQ": ("SB_off8_COND", {"k": 1}),
    "SBF_off8_NEQ": ("SB_off8_COND", {"k": 0}),
    "SBF_off8_TC": ("SB_off8_COND", {"k": 13}),
    "SBF_off8_NTC": ("SB_off8_COND", {"k": 12}),
    "SFR_ACC_T": ("SFR_ACC_1_16", {}),
    "SQRS_loc16": ("SQRA_loc16", {"b": 1}),
    "SUB_ACC_loc16": ("SUB_ACC_16sh_0_15", {"s": 0}),
    "SUB_ACC_loc16sh_1_15": ("SUB_ACC_16sh_0_15", {}),
    "SUB_ACC_loc16shT": ("SUB_ACC_16sh_0_15", {}),
    "SUBB_ACC_8": ("SUB_ACC_16sh_0_15", {"s": 0}),
    "TSET_loc16_bit": ("TCLR_loc16_bit", {"c": 1}),
    "UOUT_ind_PA_loc16": ("IN_loc16_ind_PA", {}),
    "XBANZ_pma_ind": ("XBANZ_pma_ind", {"b": 0}),
    "XBANZ_pma_indinc": ("XBANZ_pma_ind", {"b": 1}),
    "XBANZ_pma_inddec": ("XBANZ_pma_ind", {"b": 2}),
    "XBANZ_pma_ind0inc": ("XBANZ_pma_ind", {"b": 3}),
    "XBANZ_pma_ind0dec": ("XBANZ_pma_ind", {"b": 4}),
    "XBANZ_pma_ind_ARPn": ("XBANZ_pma_ind", {"b": 0}),
    "XBANZ_pma_indinc_ARPn": ("XBANZ_pma_ind", {"b": 1}),
    "XBANZ_pma_inddec_ARPn": ("XBANZ_pma_ind", {"b": 2}),
    "XBANZ_pma_ind0inc_ARPn": ("XBANZ_pma_ind", {"b": 3}),
    "XBANZ_pma_ind0dec_ARPn": ("XBANZ_pma_ind", {"b": 4}),
    "XOR_ACC_loc16": ("XOR_ACC_16sh_0_15", {"s": 0}),
    "XOR_ACC_16sh_16": ("XOR_ACC_16sh_0_15", {"s": 16}),
    "XOR_loc16_16": ("XOR_loc16_AX", {}),
    "XORB_AX_8": ("XOR_AX_loc16", {}),
    "ADDF32_RaH_16FHi_RbH": ("ADDF32_RaH_RbH_RcH", {}),
    "CMPF32_RaH_16FHi": ("CMPF32_RaH_RbH", {}),
    "CMPF32_RaH_0_0": ("CMPF32_RaH_RbH", {"i": 0}),
    "F32TOI16R_RaH_RbH": ("F32TOI16_RaH_RbH", {"s": 1}),
    "F32TOUI16R_RaH_RbH": ("F32TOUI16_RaH_RbH", {"s": 1}),
    "I16TOF32_RaH_mem16": ("I16TOF32_RaH_RbH", {}),
    "I32TOF32_RaH_mem32": ("I32TOF32_RaH_RbH", {}),
    "MACF32_R3H_R2H_RdH_ReH_RfH_par_MOV32_RaH_mem32": ("MACF32_R3H_R2H_RdH_ReH_RfH_par_MOV32_RaH_mem32", {"s": 3}),
    "MACF32_R7H_R6H_RdH_ReH_RfH_par_MOV32_RaH_mem32": ("MACF32_R3H_R2H_RdH_ReH_RfH_par_MOV32_RaH_mem32", {"s": 7}),
    "MAXF32_RaH_16FHi": ("MAXF32_RaH_RbH", {}),
    "MAXF32_RaH_RbH_par_MOV32_RcH_RdH": ("MAXF32_RaH_RbH", {}),
    "MINF32_RaH_RbH": ("MAXF32_RaH_RbH", {"b": 1}),
    "MINF32_RaH_16FHi": ("MAXF32_RaH_RbH", {"b": 1}),
    "MINF32_RaH_RbH_par_MOV32_RcH_RdH": ("MAXF32_RaH_RbH", {"b": 1}),
    "MPYF32_RaH_16FHi_RbH": ("MPYF32_RaH_RbH_RcH", {}),
    "RPTB_label_loc16": ("RPTB_label_RC", {}),
    "UI16TOF32_RaH_mem16": ("UI16TOF32_RaH_RbH", {}),
    "UI32TOF32_RaH_mem32": ("UI32TOF32_RaH_RbH", {}),
    "ZERO_RaH": ("MOVIZ_RaH_16FHiHex", {"i": 0}),
}
MODULES = (accumulator, half_words, multiply, shifts, moves, stack, branches, control, fpu, fpu_moves)


def operation(instruction: Instruction) -> Operation:
    """Return a new Operation that executes an instruction. Raise KeyError if no function executes its form."""
    encoding, values = instruction.encoding, instruction.values
    form: Operation = form_of(encoding)
    made = Operation()
    for name, value in {**values, **function_of(encoding)[1]}.items():
        setattr(made, name, value)
    made.place = made.address = instruction.address
    made.next = instruction.address + encoding.words & 0x3F_FFFF
    made.encoding, made.execute = encoding, form.execute
    made.cycles, made.not_taken = encoding.cycles_of(values)
    made.repeated = form.repeated
    made.wide, made.byte = form.wide, form.byte
    made.accesses, made.absolute, made.at_once = form.accesses, form.absolute, form.at_once
    if encoding.mnemonic == "MOV32" and made.absolute and fpu_moves.WINDOW <= made.c < fpu_moves.WINDOW_END:
        made.cycles = made.not_taken = 1  # the instruction is a move between registers
        made.absolute = 0
    return made


@cache
def function_of(encoding: Encoding) -> tuple[str, Mapping[str, int]]:
    """Return the name of the function that executes a form, and the values of fields that the form does not have."""
    name = encoding.id
    if name in EXECUTED_BY:
        return EXECUTED_BY[name]
    one = OF_ONE_XAR.fullmatch(name)
    if one:
        return f"{one[1]}n{one[3] or ''}", {"n": int(one[2])}
    return name, {}


@cache
def form_of(encoding: Encoding) -> Operation:
    """Return an operation with the properties that all operations of a form share. It is made once for each form.

    Raise KeyError if no function executes the form.
    """
    made = Operation()
    made.encoding = encoding
    bind(made, function_of(encoding)[0])
    made.repeated = encoding.repeated
    made.wide = any(operand in encoding.syntax for operand in WIDE)
    made.byte = encoding.mnemonic == "MOVB" and ("LSB" in encoding.syntax or "MSB" in encoding.syntax)
    made.accesses = (READS if "r" in encoding.accesses else 0) | (WRITES if "w" in encoding.accesses else 0)
    made.at_once = writes_at_once(encoding)
    if "*(0:16)" in encoding.syntax:
        made.absolute = WRITES if encoding.syntax.split(" ", 1)[1].startswith("*") else READS
    return made


def bind(f: Operation, name: str) -> None:
    """Make an operation execute the function of this name in one of MODULES. Raise KeyError if there is none."""
    for module in MODULES:
        try:
            module.bind(f, name)
            return
        except KeyError:
            continue
    raise KeyError(name)
