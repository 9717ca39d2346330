"""Steps on the origin of bytes that a device sent to a unit that is master.

read of a memory --> each byte's word address, and the last write to it among the transfers kept
notes of the device, broken duties --> the last one before the end of the read; it is the cause if it
                                       names a word of the read, or if the words are unknown
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from ....core.records import Kind, Record
from ....devices.targets import eeprom
from ....records.record_text import bus_byte
from .chain import Part, Step
from .evidence import Evidence, RecordedPhase
from .fault_evidence import I2C, is_master

WORD = re.compile(r"0x[0-9a-f]{4}\b")  # a word address in a note


def sender(evidence: Evidence, phase: RecordedPhase) -> str:
    """Return the device that sends the bytes of a read to the unit; "" if a unit sends them."""
    if not phase.read or not is_master(evidence, phase.begin) or any(_answers(evidence, phase)):
        return ""
    return evidence.device_at(phase.address) or phase.name or f"the device at 0x{phase.address:02X}"


def answering(evidence: Evidence, phase: RecordedPhase) -> Evidence:
    """Return the evidence about the unit that answers a read."""
    return next(_answers(evidence, phase), evidence)


def _answers(evidence: Evidence, phase: RecordedPhase) -> Iterator[Evidence]:
    """Yield the other units whose own address is that of a phase, if no device has it."""
    if evidence.device_at(phase.address):
        return
    for unit in evidence.case.unit:
        other = evidence.for_unit(unit)
        own = other.accesses(0, phase.begin, "W", I2C, "I2COAR")
        if unit != evidence.unit and own and own[-1].value == phase.address:
            yield other


def bytes_of_device(evidence: Evidence, phase: RecordedPhase) -> list[Step]:
    """Return a step for each byte of a read of a device: the memory's word, and when it was written, if known."""
    who = sender(evidence, phase)
    first = first_word(evidence, phase)
    memory = _part(evidence, phase)
    written = dict(_writes(evidence, phase)) if memory is not None else {}
    steps = []
    for number, byte in enumerate(phase.data):
        said = f"byte {number + 1}: {bus_byte(byte)}, sent by {who}"
        if memory is not None and first is not None:
            word = (first + number) % memory.size
            said += f" from {word:#06x}"
            if word in written:
                write = written[word]
                said += f", last written 0x{write.value >> 1:02X}, {evidence.span(byte.tick - write.tick)} before"
        steps.append(evidence.say(byte.tick, said))
    return steps


def note_of_device(evidence: Evidence, phase: RecordedPhase) -> tuple[list[Step], Part | None]:
    """Return the last duty noted as broken by a read's device up to its end, and the cause, if it is one."""
    who = sender(evidence, phase)
    there = (*evidence.window.before, *evidence.window.records)
    notes = [r for r in there if r.kind is Kind.NOTE and (r.where, r.what) == (who, "duty") and r.tick <= phase.end]
    if not notes:
        return [], None
    note = max(notes, key=lambda r: r.tick)
    text = f"{who}: {note.text.rpartition(' [')[0]}"
    first = first_word(evidence, phase)
    named = [int(word, 16) for word in WORD.findall(note.text)]
    concerns = first is None or not named or any(first <= word < first + len(phase.data) for word in named)
    return [evidence.say(note.tick, text)], Part("code", text, 0) if concerns else None


def _part(evidence: Evidence, phase: RecordedPhase) -> eeprom.Part | None:
    """Return the memory that is read; None for another device."""
    table = evidence.case.device.get(evidence.device_at(phase.address))
    if table is None or table.model not in eeprom.MODELS:
        return None
    part = eeprom.part_of(table.model)
    return part._replace(page=table.own.get("page") or part.page)


def first_word(evidence: Evidence, phase: RecordedPhase) -> int | None:
    """Return the word address of a read's first byte, if the write before it set it; else None."""
    memory = _part(evidence, phase)
    before = max((p for p in evidence.phases if p.end <= phase.begin), key=lambda p: p.begin, default=None)
    if memory is None or before is None or before.read or before.address != phase.address:
        return None
    return _pointer(memory, before) if len(before.data) == memory.word else None


def _pointer(memory: eeprom.Part, phase: RecordedPhase) -> int:
    block = phase.address & memory.blocks - 1
    word = int.from_bytes(bytes(byte.value >> 1 & 0xFF for byte in phase.data[: memory.word]), "big")
    return ((block << 8 if memory.word == 1 else 0) + word) % memory.size


def _writes(evidence: Evidence, read: RecordedPhase) -> Iterator[tuple[int, Record]]:
    """Yield (word, byte on the bus) of every write to a memory before a read, wrapping at the end of a page."""
    memory = _part(evidence, read)
    if memory is None:
        return
    who = evidence.device_at(read.address)
    for phase in evidence.phases:
        ours = phase.end <= read.begin and not phase.read and evidence.device_at(phase.address) == who
        if not ours or not phase.acked or len(phase.data) <= memory.word:
            continue
        first = _pointer(memory, phase)
        page = first & -memory.page
        for number, byte in enumerate(phase.data[memory.word :]):
            yield page | first + number & memory.page - 1, byte
