"""Causes of a wrong byte, a NACK or a hang: Steps with the write or read that is the cause.

byte on the bus --> the write of I2CDXR that put it there, which may have been meant for an earlier read
byte 0xFF on the bus --> the reason why no party drives SDA
NACK of an address --> the write of a wrong I2COAR or of IRS = 0, or the missing write
NACK of a byte --> the write of NACKMOD = 1
wait that ended at once because a flag was still set from before the transfer --> the read of the flag, and its rise
RSFULL --> I2CDRR was not read
read of a memory --> the word address of each byte, and the last write to this address among the recorded transfers
notes of a device on broken rules --> the last note before the end of the read; this note is the cause if it
                                      names a word of the read, or if the words are unknown
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from ....core.records import Kind, Record
from ....devices.targets import eeprom
from ....f28335.gpio.register_map import control_register
from ....f28335.i2c.descriptor import I2C_A
from ....records.record_text import bus_byte, happened
from .chain import Part, Step, place_of
from .evidence import I2C, Evidence, RecordedPhase
from .window import I2C_BUS

ONES = 0xFF  # the byte that is read when no party drives SDA
LETS_GO = "the module releases SDA"
NEEDED = (  # fields that must be 1 for the module to answer, and the effect of 0
    ("SYS", f"PCLKCR0.{I2C_A.gate}", "the module has no clock"),
    (I2C, "I2CMDR.IRS", LETS_GO),
    *(
        ("GPIO", f"{control_register('MUX', pin)}.GPIO{pin}", f"the module is not connected to {wire}")
        for wire, pin in ((wire, I2C_A.pins[signal]) for wire, signal in I2C_A.wires.items())
    ),
)
WAITED = ("SCD", "RRDY", "NACK")  # flags that firmware waits for and that remain set until cleared


def bytes_sent(evidence: Evidence, phase: RecordedPhase) -> Iterator[tuple[Record, Record | None, str]]:
    """Yield each byte of a read, the write of I2CDXR from which the byte came, and a text for a step.

    The text has the byte and the time of the write. The write is None if it is not known.
    """
    writes = evidence.accesses(0, phase.end, f"W {I2C}.I2CDXR")
    lows = evidence.window.lows.get("SCL", [])
    before = phase.begin if phase.answered is None else phase.answered
    for number, byte in enumerate(phase.data, 1):
        carried = bus_byte(byte)
        value = 0 if carried is None else carried.value
        # The tick by which the first bit must be driven.
        begins = next((rise for _, rise in lows if before < rise < byte.tick), byte.tick)
        before = byte.tick
        write = next((w for w in reversed(writes) if w.tick < begins and w.value & 0xFF == value), None)
        said = _byte_text(evidence, phase, number - 1)
        if write is None:
            yield byte, None, f"{said}, which was not written to I2CDXR within the records kept"
            continue
        early = f", written to I2CDXR {evidence.span(byte.tick - write.tick)} before its end"
        other = next((p for p in evidence.phases if p.begin <= write.tick <= p.end and p.begin < phase.begin), None)
        where = "" if write.tick >= phase.begin else f", for {other}" if other else ", before the read's START"
        yield byte, write, f"{said}{early}{where}"


def _byte_text(evidence: Evidence, phase: RecordedPhase, place: int) -> str:
    """Format a byte of a read, and the expected value if the byte is wrong. place: from 0."""
    wanted = evidence.window.expected.get((I2C_BUS, phase.begin, place))
    return f"byte {place + 1}: {bus_byte(phase.data[place])}{'' if wanted is None else f', not 0x{wanted:02X}'}"


def missing_condition(evidence: Evidence, tick: int) -> list[Step]:
    """Return a step for the first of the NEEDED fields that is 0 at a tick; an empty list if all fields are 1.

    The step names the write that cleared the field, or says that the field was never set.
    """
    unit = evidence.case.unit.get(evidence.unit)
    there = ("SYS", *(unit.modules if unit is not None else ()))
    for module, field, so in NEEDED:
        if module not in there:
            continue
        last = evidence.last_change(tick, field, module)
        if last is None:
            return [evidence.say(tick, f"{field} = 0, so {so}: the firmware has never set it")]
        change, made_by = last
        if not change.value:
            text = f"{change.what} cleared, so {so}, {evidence.span(tick - change.tick)} before"
            return [evidence.step(made_by, text)]
    return []


def own_address(evidence: Evidence, tick: int, address: int) -> tuple[list[Step], list[Step]]:
    """Return steps for the writes of I2COAR, the own address, around a tick at which `address` was not acknowledged.

    The second result has the step that is the cause, and is empty if the own address was right.
    """
    what = f"W {I2C}.I2COAR"
    last = evidence.last_access(tick, what)
    if last is None:
        steps = [evidence.say(tick, "I2COAR = 0x00: the firmware has never written it")]
    else:
        before = evidence.span(tick - last.tick)
        steps = [evidence.step(last, f"I2COAR = 0x{last.value:02X} written, {before} before the NACK")]
        if last.value == address:
            return steps, []
    later = evidence.accesses(tick + 1, evidence.window.kept[-1].end, what)
    right = [
        evidence.step(r, f"I2COAR = 0x{address:02X} written, {evidence.span(r.tick - tick)} too late")
        for r in later
        if r.value == address
    ]
    steps += right[:1]
    return steps, steps[-1:]


def refusing(evidence: Evidence, tick: int) -> list[Step]:
    """Return a step for the reason why the module sends a NACK at a tick: NACKMOD = 1, or else a field in NEEDED."""
    last = evidence.last_change(tick, "I2CMDR.NACKMOD")
    if last is None or not last[0].value:
        return missing_condition(evidence, tick)
    text = f"I2CMDR.NACKMOD set, so the module refuses the next byte, {evidence.span(tick - last[0].tick)} before"
    return [evidence.step(last[1], text)]


def is_master(evidence: Evidence, tick: int) -> bool:
    """Return True if the unit's module is the master at a tick. Its bytes are then acknowledged by other parties."""
    return evidence.last_set(tick, "I2CMDR.MST") is not None


def stale(evidence: Evidence, phase: RecordedPhase) -> list[Step]:
    """Return a step for the first read, during a phase, of a flag that rose before the START of the transfer.

    Such a flag ends a wait at once. Return an empty list if there is no such read.
    """
    starts = (p.begin for p in reversed(evidence.phases) if p.begin <= phase.begin and p.start == "START")
    first = next(starts, phase.begin)
    for look_at in (r for r in evidence.accesses(phase.begin, phase.end, f"R {I2C}.I2CSTR") if r.field in WAITED):
        rose = evidence.last_set(look_at.tick, f"I2CSTR.{look_at.field}")
        if rose is not None and rose.tick < first:
            early = evidence.span(first - rose.tick)
            text = f"the firmware sees I2CSTR.{look_at.field}, which rose {early} before this transfer began"
            return [evidence.step(look_at, text)]
    return []


def unread(evidence: Evidence, tick: int) -> list[Step]:
    """Return steps for an unread byte in the receiver (RSFULL): when it was received, and the last read of I2CDRR."""
    full = evidence.last_set(tick, "I2CSTR.RSFULL")
    if full is None:
        return []
    steps = [evidence.step(full, "I2CSTR.RSFULL set: a second byte is in, and I2CDRR is unread")]
    last = evidence.last_access(tick, f"R {I2C}.I2CDRR")
    if last is not None:
        return [evidence.step(last, f"I2CDRR read for the last time, {evidence.span(tick - last.tick)} before"), *steps]
    waits = evidence.last_set(tick, "I2CSTR.RRDY")
    return steps if waits is None else [evidence.step(waits, "I2CSTR.RRDY set; I2CDRR was not read since"), *steps]


def waited_for(evidence: Evidence, tick: int) -> list[Step]:
    """Return steps for a wait that is in progress at a tick: its place, and the last changes of the polled fields."""
    wait = evidence.activity_at(tick)
    if wait is None or wait.doing != "wait":
        return []
    steps = [evidence.say(wait.begin, f"{wait} begins, and goes on", None, place_of(wait.where))]
    for field in wait.what.split(" and "):
        module, _, what = field.partition(".")
        last = evidence.last_change(tick, what, module)
        if last is not None:
            change, made_by = last
            by = f" by {happened(made_by)}" if made_by is not change else ""
            steps.append(evidence.step(made_by, f"{happened(change)}{by}"))
    return steps


WORD = re.compile(r"0x[0-9a-f]{4}\b")  # a word address in a note


def sender(evidence: Evidence, phase: RecordedPhase) -> str:
    """Return the device that sends the bytes of a read to the unit; "" if a unit sends them or the phase is a write."""
    if not phase.read or not is_master(evidence, phase.begin) or any(_answers(evidence, phase)):
        return ""
    return evidence.devices.get(phase.address, "") or phase.name or f"the device at 0x{phase.address:02X}"


def answering(evidence: Evidence, phase: RecordedPhase) -> Evidence:
    """Return the evidence about the unit that answers a read; `evidence` itself if no other unit answers."""
    return next(_answers(evidence, phase), evidence)


def _answers(evidence: Evidence, phase: RecordedPhase) -> Iterator[Evidence]:
    """Yield evidence about the units that answer in a phase in place of the unit of `evidence`.

    These are the other units whose own address (I2COAR) is the address in `phase`. Yield nothing if a device has this
    address.
    """
    if phase.address in evidence.devices:
        return
    for unit in evidence.case.unit:
        other = evidence.for_unit(unit)
        own = other.last_access(phase.begin, f"W {I2C}.I2COAR")
        if unit != evidence.unit and own is not None and own.value == phase.address:
            yield other


def bytes_of_device(evidence: Evidence, phase: RecordedPhase) -> list[Step]:
    """Return a step for each byte of a read of a device.

    For a memory, the step states the word address and, if known, the last write to this address.
    """
    who = sender(evidence, phase)
    first = first_word(evidence, phase)
    memory = _part(evidence, phase)
    written = dict(_writes(evidence, phase, memory)) if memory is not None else {}
    steps = []
    for number, byte in enumerate(phase.data):
        said = f"{_byte_text(evidence, phase, number)}, sent by {who}"
        if memory is not None and first is not None:
            word = (first + number) % memory.size
            said += f" from {word:#06x}"
            if word in written:
                write = written[word]
                said += f", last written 0x{write.value >> 1:02X}, {evidence.span(byte.tick - write.tick)} before"
        steps.append(evidence.say(byte.tick, said))
    return steps


def note_of_device(evidence: Evidence, phase: RecordedPhase) -> tuple[list[Step], Part | None]:
    """Return a step for the last note on a broken rule that the device made before the end of a read, and the cause.

    The list of steps is empty if the device made no such note. The second result is the broken rule as the cause of the
    wrong bytes. It is None if there is no note, or if the note names only words that were not read.
    """
    who = sender(evidence, phase)
    note = evidence.last(phase.end, Kind.NOTE, who, "duty")
    if note is None:
        return [], None
    text = f"{who}: {note.text.rpartition(' [')[0]}"
    first = first_word(evidence, phase)
    named = [int(word, 16) for word in WORD.findall(note.text)]
    concerns = first is None or not named or any(first <= word < first + len(phase.data) for word in named)
    return [evidence.say(note.tick, text)], Part("code", text, 0) if concerns else None


def _part(evidence: Evidence, phase: RecordedPhase) -> eeprom.Part | None:
    """Return the type of the memory that a phase addresses; None if it addresses another device."""
    table = evidence.case.device.get(evidence.devices.get(phase.address, ""))
    if table is None or table.model not in eeprom.MODELS:
        return None
    part = eeprom.part_of(table.model)
    return part._replace(page=table.own.get("page") or part.page)


def first_word(evidence: Evidence, phase: RecordedPhase) -> int | None:
    """Return the word address of a read's first byte; None if no memory is read or the phase before set no address."""
    memory = _part(evidence, phase)
    before = max((p for p in evidence.phases if p.end <= phase.begin), key=lambda p: p.begin, default=None)
    if memory is None or before is None or before.read or before.address != phase.address:
        return None
    return _pointer(memory, before) if len(before.data) == memory.word else None


def _pointer(memory: eeprom.Part, phase: RecordedPhase) -> int:
    block = phase.address & memory.blocks - 1
    word = int.from_bytes(bytes(byte.value >> 1 & 0xFF for byte in phase.data[: memory.word]), "big")
    return ((block << 8 if memory.word == 1 else 0) + word) % memory.size


def _writes(evidence: Evidence, read: RecordedPhase, memory: eeprom.Part) -> Iterator[tuple[int, Record]]:
    """Yield the word address and the record of each byte that was written to a memory before a read.

    At the end of a page, the word address wraps to the beginning of the page.
    """
    who = evidence.devices.get(read.address, "")
    for phase in evidence.phases:
        ours = phase.end <= read.begin and not phase.read and evidence.devices.get(phase.address, "") == who
        if not ours or not phase.acked or len(phase.data) <= memory.word:
            continue
        first = _pointer(memory, phase)
        page = first & -memory.page
        for number, byte in enumerate(phase.data[memory.word :]):
            yield page | first + number & memory.page - 1, byte
