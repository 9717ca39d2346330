"""Causes of wrong characters on a serial line: Steps with the writes of SCITXBUF.

wrong reply                        --> the request, and the writes of characters that differ from the expected ones
                                       (the expected text comes from the case and not from a record)
characters that nothing asked for  --> their writes, after a send or in the whole run
reply that never came              --> the interrupts, the characters read and the waits that timed out since the
                                       request began, and the firmware's activity at the time limit of the reply, or at
                                       the next send of the host if this is earlier
"""

from __future__ import annotations

from collections import Counter

from ....core.phrases import counted
from ....core.records import Kind, Record
from ....records.record_text import GAVE_UP
from ....scene.case.serial import ExpectTable, SerialTable, content_of
from ....timing.budget_schema import REPLY, SILENCE
from ....timing.measures.factory import UNSOLICITED
from .chain import Step
from .cpu_activity import all_episodes
from .evidence import Evidence
from .occurrence import never_came

MOST_CHARACTERS = 8  # maximum number of wrong characters that are listed
MOST_TIMEOUTS = 4  # maximum number of waits that are listed because they timed out
MOST_READ = 16  # maximum number of characters that are listed as read


WrongCharacter = tuple[Record, Step, int | None]  # start of its frame, write of SCITXBUF, expected value or None


def request_of(evidence: Evidence) -> list[Step]:
    """Return a step for the last character of the request of a reply; an empty list if it is unknown."""
    last = _asked(evidence)[-1:] if evidence.window.verdict.measure.startswith(REPLY) else []
    return [evidence.say(r.tick, f"{r.where}: the last character of what asks for it") for r in last]


def unanswered(evidence: Evidence) -> list[Step]:
    """Return steps about the firmware since the request of a reply that did not come; an empty list if it came."""
    window, verdict = evidence.window, evidence.window.verdict
    if not never_came(verdict):
        return []
    _, table = _expected(evidence)
    unit, _, module = table.from_.rpartition(".")
    of = evidence.for_unit(unit) if unit else evidence
    since = _began(evidence, table, _asked(evidence))
    records = [r for r in window.between(since, window.end) if r.where == of.unit]
    least = "at least " if window.hole else ""
    steps = []
    entered = [r for r in records if r.kind is Kind.IRQ and r.value]
    for vector, count in Counter(r.what for r in entered).items():
        first = next(r for r in entered if r.what == vector)
        steps.append(of.say(first.tick, f"{vector} entered, {least}{counted(count, 'time')} since the request began"))
    read = [r for r in records if r.kind is Kind.ACCESS and r.what == f"R {module}.SCIRXBUF"]
    if read:
        values = " ".join(f"{r.value & 0xFF:#04x}" for r in read[:MOST_READ])
        more = ", ..." if len(read) > MOST_READ else ""
        text = f"SCIRXBUF read, {least}{counted(len(read), 'time')} since the request began: {values}{more}"
        steps.append(of.step(read[0], text))
    waits = (one for one in all_episodes(window, of.unit, since, window.end) if one.doing == "wait")
    gave_up = [one for one in waits if one.what.endswith(GAVE_UP)]
    for one in gave_up[:MOST_TIMEOUTS]:
        steps.append(of.episode_step(one, window.end))
    if len(gave_up) > MOST_TIMEOUTS:
        later = gave_up[MOST_TIMEOUTS]
        steps.append(of.say(later.begin, f"{counted(len(gave_up) - MOST_TIMEOUTS, 'wait')} more {GAVE_UP}"))
    none = [what for what, there in (("no interrupt is entered", entered), ("SCIRXBUF is not read", read)) if not there]
    if none:
        steps.append(of.say(since, f"{' and '.join(none)} from here on{' in the records kept' if least else ''}"))
    return [*steps, of.doing_step(window.end)]


def wrong_characters(evidence: Evidence) -> list[WrongCharacter]:
    """Return the first wrong characters of a wrong reply, or the first characters where an SCI must be silent.

    There are at most MOST_CHARACTERS; none if the verdict is about something else.
    """
    verdict = evidence.window.verdict
    if verdict.measure == UNSOLICITED or verdict.measure.startswith(SILENCE):
        found = _unsolicited(evidence, verdict.measure.removeprefix(SILENCE))[:MOST_CHARACTERS]
        what = "{}: SCITXBUF written, {:#04x}: unsolicited"
        return [(frame, evidence.step(r, what.format(r.where, r.value & 0xFF)), None) for frame, r in found]
    wrong = verdict.measure.startswith(REPLY) and verdict.until_s is not None and not never_came(verdict)
    return _wrong(evidence, _asked(evidence)) if wrong else []


def _unsolicited(evidence: Evidence, name: str) -> list[tuple[Record, Record]]:
    """Return the frames of the occurrence, with their writes, from the SCI that sent the first frame.

    name: the name of the send after which the SCI must be silent. UNSOLICITED for all SCIs to which the case sends or
        from which it expects replies, in the whole run.
    """
    serial, begin = _serial(evidence), evidence.window.begin
    named = [send.to for send in serial.send if name in (UNSOLICITED, send.name)]
    sources = [*named, *([one.from_ for one in serial.expect] if name == UNSOLICITED else [])]
    found = [written for source in dict.fromkeys(sources) if (written := _written(evidence, source, begin))]
    return min(found, key=lambda written: written[0][0].tick, default=[])


def _asked(evidence: Evidence) -> list[Record]:
    """Return the records of the beginnings of frames on the serial line of the request, up to the end of the request.

    The request ends with the frame whose end is the start of the occurrence. Return an empty list if there is no such
    frame.
    """
    window = evidence.window
    slip = window.timebase.per_second // 10**7
    frames = [r for r in window.records if r.kind is Kind.FRAME]
    last = next((r for r in frames if r.what == "end" and abs(r.tick - window.begin) <= slip), None)
    if last is None:
        return []
    return [r for r in frames if r.what == "begin" and r.where == last.where and r.tick < last.tick]


def _wrong(evidence: Evidence, asked: list[Record]) -> list[WrongCharacter]:
    """Return the wrong characters in a reply.

    A character is wrong if it differs from the expected character at the same position of the reply. Return an empty
    list if the positions are unknown.
    """
    number, table = _expected(evidence)
    since = _since(evidence, table, asked)
    if since is None or table.anywhere:
        return []
    bits = _serial(evidence).form(table).bits
    expected = content_of(evidence.case, table, bits, "serial", "expect", number)
    found = []
    for at, (frame, write) in enumerate(_written(evidence, table.from_, since)):
        wanted = expected[at] if at < len(expected) else None
        if write.value & (1 << bits) - 1 != wanted:
            right = "" if wanted is None else f", not {wanted:#04x}"
            what = f"SCITXBUF written, {write.value & 0xFF:#04x}: character {at} of the reply{right}"
            found.append((frame, evidence.step(write, f"{write.where}: {what}"), wanted))
    return found[:MOST_CHARACTERS]


def _expected(evidence: Evidence) -> tuple[int, ExpectTable]:
    """Return the position of the expected reply among the replies of the case, from 0, and its table."""
    name = evidence.window.verdict.measure.removeprefix(REPLY)
    return next((n, one) for n, one in enumerate(_serial(evidence).expect) if one.name == name)


def _serial(evidence: Evidence) -> SerialTable:
    assert evidence.case.serial is not None  # otherwise, there is no verdict about serial lines
    return evidence.case.serial


def _since(evidence: Evidence, table: ExpectTable, asked: list[Record]) -> int | None:
    """Return the tick from which characters belong to the reply; None if this tick may be before the window."""
    serial = _serial(evidence)
    if table.after_send is None:
        return evidence.window.begin
    number, send = next((n, s) for n, s in enumerate(serial.send) if table.after_send in (s.name, f"send {n}"))
    count = len(content_of(evidence.case, send, serial.form(send).bits, "serial", "send", number))
    count += send.address is not None
    if 0 < count <= len(asked):
        return asked[-count].tick
    kept, begin = evidence.window.kept[0].begin, evidence.window.begin
    early = len(_written(evidence, table.from_, kept)) > len(_written(evidence, table.from_, begin))
    return None if early else begin


def _began(evidence: Evidence, table: ExpectTable, asked: list[Record]) -> int:
    """Return the tick at which the request of a reply began.

    A request may be sent in parts. The pauses between its parts are shorter than the time limit of the reply, and the
    SCI sends nothing in them.
    """
    window = evidence.window
    since = _since(evidence, table, asked)
    if table.after_send is None or since is None:
        return window.begin if since is None else since
    pause = window.timebase.ticks(table.within, "nearest")
    replies = {frame.tick for frame, _ in _written(evidence, table.from_, window.kept[0].begin)}
    last_reply = max((tick for tick in replies if tick < since), default=window.kept[0].begin - 1)
    for frame in reversed([r for r in asked if last_reply < r.tick < since]):
        if since - frame.tick > pause:
            break
        since = frame.tick
    return since


def _written(evidence: Evidence, source: str, since: int) -> list[tuple[Record, Record]]:
    """Return the frames from an SCI between a tick and the end of the occurrence, each with its write of SCITXBUF.

    source: the SCI, as UNIT.MODULE, or as MODULE for any unit.
    """
    unit, _, module = source.rpartition(".")
    found = []
    for frame in evidence.window.between(since, evidence.window.end - 1, Kind.FRAME):
        if frame.what == "begin":
            causes = (cause for cause, _ in evidence.walk(frame, 2))
            found += [(frame, r) for r in causes if r.what == f"W {module}.SCITXBUF" and unit in ("", r.where)]
    return found
