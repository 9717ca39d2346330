"""Data flow of instructions: the parts of registers that the data of an instruction come from, and go to.

    ADD ACC,loc16   sources: AL AH SXM OVM   replaces: AL AH N Z C   changes: V OVC   (V and OVC keep old values, too)

Memory is not included, because the words that an instruction accesses are known only when it is executed. Registers
from which addresses are computed are not sources either; see `pipeline.addressing`.

Source: the columns `reads`, `writes`, `flags` and `depends` of `encodings.toml`. A test changes each part before
instructions of each form, and compares what follows with the result of `data_flow`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from .delay_slots import ALL
from .encodings import LOCATIONS, REGISTERS, WIDE, Encoding, places
from .operands import FPU_APART, FPU_FIRST, MOVST0_BITS, REGISTER_FIELDS, STATUS_BITS, UNCF
from .pipeline import BY_ARP, addressing

# Names of the parts of registers, in the order of their bits in a mask. Some names cover several flags or registers:
#
#     NF      NF and ZF             SHADOW  the shadow registers of the FPU
#     NI      NI and ZI             SYSTEM  SP, DP, ST1, RPC, RB, RPTC, PC, and interrupt registers: they control which
#     LVF     LVF and LUF                   instruction is executed next, and how
PARTS = (
    *("AL", "AH", "PL", "PH", "TL", "T"),
    *(f"AR{n}{half}" for n in range(8) for half in ("", "H")),
    *("N", "Z", "C", "V", "TC", "OVC", "PM", "SXM", "OVM"),
    *(f"R{n}H" for n in range(8)),
    *("NF", "NI", "LVF", "TF", "RND32", "SHADOW", "SYSTEM"),
)
BITS = {name: 1 << bit for bit, name in enumerate(PARTS)}


def mask_of(names: str) -> int:
    """Return the mask of the parts with these names, which are separated by spaces."""
    return sum(BITS[name] for name in names.split())


ST0 = mask_of("N Z C V TC OVC PM SXM OVM")
SYSTEM = BITS["SYSTEM"]
XAR = tuple(mask_of(f"AR{n} AR{n}H") for n in range(8))
ANY_XAR = sum(XAR)
ANY_FLOAT = mask_of(" ".join(f"R{n}H" for n in range(8)))
STF = mask_of("NF NI LVF TF RND32")
# For names in the columns of `encodings.toml`, the parts that they stand for.
NAMED = BITS | {f"XAR{n}": XAR[n] for n in range(8)}
NAMED |= {"ACC": mask_of("AL AH"), "P": mask_of("PL PH"), "XT": mask_of("TL T"), "ST0": ST0, "STF": STF}
NAMED |= {"XAR[ARP]": ANY_XAR, "AR[ARP]": ANY_XAR, ALL: ANY_FLOAT, "shadow": BITS["SHADOW"]}
NAMED |= {
    "ZF": BITS["NF"],
    "ZI": BITS["NI"],
    "LUF": BITS["LVF"],
    "OVCU": BITS["OVC"],
    "RNDF32": BITS["RND32"],
    "SP": SYSTEM,
}
NAMED |= {"COND": 0, "CNDF": 0, "SPA": 0}
NAMED |= dict.fromkeys(("ST1", "IER", "IFR", "DBGIER", "DBGSTAT", "RPC", "RB", "RPTC", "DP", "PC", "ARP"), SYSTEM)
MEMORY = re.compile(r"mem\[loc\+\d\]|mem|prog|stack|io|address|regs")
# For the code of a condition, the parts that it tests [SPRU430F Table 2-10; SPRUEO2A Table 2-6].
COND = ("Z", "Z", "Z N", "N", "N", "Z N", "C Z", "C", "C", "C Z", "V", "V", "TC", "TC", "", "")
CNDF = ("NF", "NF", "NF", "NF", "NF", "NF", "", "", "", "", "TF", "TF", "LVF", "LVF", "", "")
# Flags that an instruction always writes, as texts of the column `flags`. Any other flag can keep its value.
REPLACED = re.compile(r"(?:^| )(?:(N|Z|C|TC|NF|ZF|NI|ZI|TF)|(N):exact|(N|Z|C|V|NF|OVC)=[01])(?= |$)")
OF_RESULT = re.compile(r"nz@(AX|ACC)")
ACC_FIELDS = (0xA8, 0xA9)  # values of field l for @AH and @AL, or @ACC
UNCONDITIONAL = " with UNCF"  # in the column `flags`: the flags before this text are written if field w is UNCF
SELECTED_BY_ARP = ("XAR[ARP]", "AR[ARP]")
PARTIAL = (*SELECTED_BY_ARP, "ST0", "STF")  # registers that an instruction may write only in part
# Forms whose instructions may write each of their registers only in part.
PARTLY = re.compile(r"[LM]SB|POP_AR1H_AR0H|NORM|par_MOV32_RcH")
WINDOW_FORMS = ("MOV32_loc32_ind_0_16", "MOV32_ind_0_16_loc32")
FLOAT_WINDOW = range(FPU_FIRST, FPU_FIRST + 8 * FPU_APART, FPU_APART)  # addresses with which these move from or to RnH


class DataFlow(NamedTuple):
    """The data flow of an instruction, as masks of PARTS.

    sources: the parts on which results can depend.
    replaces: the parts that the instruction always overwrites, so that their old values have no effect.
    changes: further parts that the instruction can change.
    decides: the sources that decide what the CPU executes next, or which results are written.
    memory_decides: True if a memory word that is read decides this, too.
    pointers: the parts from which the address of the operand in memory is computed.
    """

    sources: int
    replaces: int
    changes: int
    decides: int
    memory_decides: bool
    pointers: int


def data_flow(encoding: Encoding, fields: Mapping[str, int]) -> DataFlow:
    """Return the data flow of an instruction. fields: the values of its fields, by their letters."""
    if encoding.id in BY_FIELD:
        return BY_FIELD[encoding.id](fields)
    read, written = (places(column) for column in (encoding.reads, encoding.writes))
    tested = _tested(encoding, fields)
    sources = tested | _parts([*read, *encoding.depends.split()], encoding, fields)
    results = _parts([name for name in written if name not in ("SP", *PARTIAL)], encoding, fields)
    partial = _parts([name for name in written if name in PARTIAL], encoding, fields)
    if any(name in LOCATIONS or MEMORY.fullmatch(name) for name in read):
        pointers = _parts(
            [name for name in ("XAR7", *SELECTED_BY_ARP) if f"{name}@D2" in encoding.writes], encoding, fields
        )
        results, partial = results & ~pointers, partial & ~pointers
    replaced, changed = _flags(encoding, fields)
    if tested or PARTLY.search(encoding.id):
        partial |= results
        results = 0
    system = (results | partial) & SYSTEM or encoding.mnemonic.startswith("LOOP")
    window = encoding.id in WINDOW_FORMS and fields["c"] in FLOAT_WINDOW
    if window:
        number = BITS[f"R{(fields['c'] - FPU_FIRST) // FPU_APART}H"]
        sources, results = (sources, results | number) if "loc32" in read else (sources | number, results)
    replaces = (results | replaced) & ~SYSTEM
    return DataFlow(
        sources & ~SYSTEM,
        replaces,
        (partial | changed) & ~(replaces | SYSTEM),
        (sources if system else tested) & ~SYSTEM,
        bool(system),
        _pointers(encoding, fields),
    )


def _parts(names: Iterable[str], encoding: Encoding, fields: Mapping[str, int]) -> int:
    """Return the parts that these names of the columns `reads`, `writes` and `depends` stand for; 0 for memory."""
    found = 0
    for name in names:
        if name in LOCATIONS:
            found |= _operand(fields["l"], name in WIDE)
        elif name in REGISTER_FIELDS:
            found |= BITS[f"R{fields[REGISTER_FIELDS[name]]}H"]
        elif name in ("ARn", "ARm"):
            found |= BITS[f"AR{fields[name[-1]]}"]
        elif name == "XARn":
            found |= XAR[fields["n"]]
        elif name == "AX":
            found |= BITS["AH" if fields["x"] else "AL"]
        elif not MEMORY.fullmatch(name):
            found |= NAMED[name]
    return found


def _operand(field: int, wide: bool) -> int:
    """Return the parts, as a mask of PARTS, of the register that is an instruction's operand; 0 for memory.

    field: the field of the instruction that encodes the operand, with the letter l in `encodings.toml`.
    wide: True if the operand has 32 bits, False if it has 16.
    """
    if field not in REGISTERS:
        return 0
    if field < REGISTERS.start + 8:
        return XAR[field & 7] if wide else BITS[f"AR{field & 7}"]
    return NAMED[("ACC ACC P P XT" if wide else "AH AL PH PL T SP").split()[field - REGISTERS.start - 8]]


def _pointers(encoding: Encoding, fields: Mapping[str, int]) -> int:
    """Return the parts from which an instruction computes addresses of memory words that it accesses."""
    found = 0
    if "prog" in places((*encoding.reads, *encoding.writes)):
        found = XAR[7] if "*XAR7" in encoding.syntax else BITS["AL"] if "*AL" in encoding.syntax else 0
    registers = addressing(fields["l"]) if "l" in fields else 0
    return found | sum(XAR[n] for n in range(8) if registers & (1 << n | BY_ARP) and not found & XAR[n])


def _tested(encoding: Encoding, fields: Mapping[str, int]) -> int:
    """Return the parts that the condition of a conditional instruction tests; 0 if its condition is always true."""
    if "COND" in encoding.depends:
        return mask_of(COND[fields["k"]])
    return mask_of(CNDF[fields["w"]]) if "CNDF" in encoding.depends else 0


def _flags(encoding: Encoding, fields: Mapping[str, int]) -> tuple[int, int]:
    """Return the flags that an instruction always writes, and those that it can change."""
    text = encoding.flags
    if of_result := OF_RESULT.search(text):
        text = text.replace(of_result[0], "N Z" if fields["l"] in ACC_FIELDS else "")
    if UNCONDITIONAL in text:
        text = text.partition(UNCONDITIONAL)[0] if fields["w"] == UNCF else ""
    replaced = {next(filter(None, found)) for found in REPLACED.findall(text)}
    changed = {name for name in re.findall(r"\w+", text) if name in NAMED}
    return _mask(replaced), _mask(changed)


def _mask(names: Iterable[str]) -> int:
    found = 0
    for name in names:
        found |= NAMED[name]
    return found


def _move_to_st0(fields: Mapping[str, int]) -> DataFlow:
    """Return the data flow of MOVST0, which copies the flags of STF that field g selects."""
    flags = fields["g"]
    sources = _mask(name for name, bit in MOVST0_BITS.items() if flags >> bit & 1)
    results = (("LVF", "LUF"), "V"), (("NF", "NI"), "N"), (("ZF", "ZI"), "Z"), (("TF",), "C TC")
    replaces = _mask(
        name
        for copied, names in results
        for name in names.split()
        if any(flags >> MOVST0_BITS[one] & 1 for one in copied)
    )
    return DataFlow(sources, replaces, sources & BITS["LVF"], 0, False, 0)


def _set_mode(fields: Mapping[str, int]) -> DataFlow:
    """Return the data flow of SETC and CLRC, which set or clear the bits that field y selects."""
    selected = _mask(name for bit, name in enumerate(STATUS_BITS) if fields["y"] >> bit & 1 and name in NAMED)
    return DataFlow(0, selected, 0, 0, False, 0)


BY_FIELD = {"MOVST0_FLAG": _move_to_st0, "SETC_mode": _set_mode, "CLRC_mode": _set_mode}
