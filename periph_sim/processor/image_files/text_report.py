"""Text and JSON dictionaries of an image's summary and of the cycles of a function."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...core.text_table import columns, paragraph, text_table
from ...f28335.memory.address_space import NOT_MODELLED
from ..c28x.decoder import other_unit
from .function_cycles import FunctionCycles
from .functions import Function
from .inspection import Inspection, Register, contents_of
from .load import shared_memory

LONGEST_TEXT = 10  # number of functions shown without -v


def text(found: Inspection, every: bool = False) -> str:
    """Format the summary in 80 columns. every: all functions, and which ones access each register."""
    image = found.image
    version = f", linker {image.tool_version}" if image.tool_version else ""
    lines = [
        f"{image.kind}{version}, entry {image.entry:#08x} ({found.entry_name})",
        f"{found.instructions} instructions in {found.words} words of code, {_unknown_count(found)}",
    ]
    if found.debug_damaged:
        lines += paragraph(f"note: debug data are damaged and partly read ({found.debug_damaged})")
    for sentence in shared_memory(image):
        lines += paragraph(f"note: {sentence}")
    lines += ["", *_sections(found), "", *_vectors(found), "", *_registers(found, every), "", *_functions(found, every)]
    if found.unknown:
        lines += ["", *_unknown(found)]
    return "\n".join(lines)


def _unknown_count(found: Inspection) -> str:
    count = len(found.unknown)
    return "all known" if not count else f"{count} unknown word{'s' * (count > 1)}"


def _sections(found: Inspection) -> list[str]:
    rows = []
    for section in found.image.sections:
        contents = contents_of(section)
        if contents in ("", "registers"):
            continue
        runs = f"{section.run:#08x}" if section.copied else ""
        rows.append((section.name, f"{section.address:#08x}", runs, str(section.size), contents))
    if found.image.initial:
        words = sum(len(words) for _, words in found.image.initial)
        rows.append((".cinit, applied", "", "", str(words), "data that the loader writes"))
    return text_table(("section", "loaded at", "runs at", "words", "contents"), rows, right=(3,))


def _vectors(found: Inspection) -> list[str]:
    if not found.vectors:
        return ["no vector is stored to a constant address"]
    rows = [(one.name, f"{one.address:#06x}", one.handler, one.stored_in) for one in found.vectors]
    return text_table(("vector", "address", "handler", "stored in"), rows)


def _registers(found: Inspection, every: bool) -> list[str]:
    if not found.registers:
        return ["no register is accessed by a constant address"]
    if every:
        rows = [
            (
                f"{one.module} {one.name}",
                f"{one.address:#06x}",
                str(one.reads),
                str(one.writes),
                ", ".join(one.functions),
            )
            for one in found.registers
        ]
        return text_table(("register", "address", "reads", "writes", "in"), rows, right=(2, 3))
    modules: dict[str, list[Register]] = {}
    for one in found.registers:
        modules.setdefault(one.module, []).append(one)
    rows_by_module = [(module or "-", ", ".join(one.name for one in named)) for module, named in modules.items()]
    lines = text_table(("module", "registers touched"), rows_by_module)
    absent = [module for module in modules if module in {one.name for one in NOT_MODELLED}]
    return [*lines, *paragraph(f"not modelled: {', '.join(absent)}", then="    ")] if absent else lines


def _functions(found: Inspection, every: bool) -> list[str]:
    largest = sorted(found.functions, key=lambda function: (-function.size, function.address))
    shown = found.functions if every else largest[:LONGEST_TEXT]
    rows = [(one.name, f"{one.address:#08x}", str(one.size), str(one.source or "")) for one in shown]
    lines = text_table(("function", "address", "words", "source"), rows, right=(2,))
    left_out = len(found.functions) - len(shown)
    return [*lines, f"and {left_out} smaller functions; -v lists all"] if left_out else lines


def _unknown(found: Inspection) -> Iterator[str]:
    yield "words of code that are not instructions of the F28335:"
    rows = [(f"{one.address:#08x}", f"{one.word:#06x}", one.function, other_unit(one.word)) for one in found.unknown]
    yield from (line.rstrip() for line in columns(rows))


def cycles_text(found: FunctionCycles) -> str:
    """Format one line per instruction, then the total."""
    rows = [
        (f"{row.address:#08x}", row.text, row.published, str(row.stall or ""), row.why, row.line) for row in found.rows
    ]
    stalls = sum(row.stall for row in found.rows)
    return "\n".join(
        [
            *text_table(("address", "instruction", "cycles", "stall", "why", "line"), rows, right=(2, 3)),
            "",
            *paragraph(
                f"{found.function.name}: {found.least} cycles with no condition true, {stalls} of them stalls by rule. "
                "cycles: published, taken/not taken. Not included: wait states of registers, accesses through pointers."
            ),
        ]
    )


def cycles_as_json(found: FunctionCycles) -> dict[str, object]:
    """Return the cycles as a dictionary."""
    function = found.function
    rows = [row._asdict() for row in found.rows]
    return {"function": function.name, "address": function.address, "cycles": found.least, "rows": rows}


def as_json(found: Inspection) -> dict[str, object]:
    """Return the summary as a dictionary; addresses are numbers."""
    image = found.image
    return {
        "kind": image.kind,
        "linker": image.tool_version,
        "entry": {"address": image.entry, "name": found.entry_name},
        "instructions": found.instructions,
        "words": found.words,
        "sections": [
            {
                "name": section.name,
                "loaded_at": section.address,
                "runs_at": section.run,
                "words": section.size,
                "contents": contents_of(section),
            }
            for section in image.sections
            if section.allocated
        ],
        "vectors": [one._asdict() for one in found.vectors],
        "registers": [one._asdict() for one in found.registers],
        "functions": _function_rows(found.functions),
        "unknown": [one._asdict() for one in found.unknown],
        "debug_damaged": found.debug_damaged,
        "shared_memory": shared_memory(image),
    }


def _function_rows(functions: Sequence[Function]) -> list[dict[str, object]]:
    return [
        {
            "name": one.name,
            "address": one.address,
            "words": one.size,
            "section": one.section,
            "file": one.source.file if one.source else None,
            "line": one.source.line if one.source else None,
        }
        for one in functions
    ]
