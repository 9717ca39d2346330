"""Steps of a late or wrong reply: its request, and the wrong writes. The expected text is in the case, not recorded.

RX  |--ask--|
CPU         w(E) w(R)            the writes of the characters that are not the expected ones
TX          |---E---|---R---|
"""

from __future__ import annotations

from ....core.records import Kind, Record
from ....scene.case.serial import ExpectTable, SerialTable
from ....scene.serial.content import content_of
from ....timing.budget_schema import REPLY
from .chain import Step
from .evidence import Evidence

MOST = 8  # wrong characters listed


def wrong_characters(evidence: Evidence) -> tuple[list[Step], list[Step]]:
    """Return steps of what asks for a reply, and of the writes of the reply's wrong characters."""
    window = evidence.window
    if not window.verdict.measure.startswith(REPLY):
        return [], []
    asked = _asked(evidence)
    last = [evidence.say(r.tick, f"{r.where}: the last character of what asks for it") for r in asked[-1:]]
    return last, _wrong(evidence, asked) if window.verdict.until_s is not None else []


def _asked(evidence: Evidence) -> list[Record]:
    """Return the begins of frames on the request's line, up to the one that ended when the reply's time began."""
    window = evidence.window
    slip = window.timebase.per_second // 10**7
    frames = [r for r in window.records if r.kind is Kind.FRAME]
    last = next((r for r in frames if r.what == "end" and abs(r.tick - window.begin) <= slip), None)
    if last is None:
        return []
    return [r for r in frames if r.what == "begin" and r.where == last.where and r.tick < last.tick]


def _wrong(evidence: Evidence, asked: list[Record]) -> list[Step]:
    """Return the writes of characters other than expected at their places; none if their places are unknown."""
    serial = evidence.case.serial
    assert serial is not None
    name = evidence.window.verdict.measure.removeprefix(REPLY)
    number, table = next((n, one) for n, one in enumerate(serial.expect) if one.name == name)
    since = _since(evidence, serial, table, asked)
    if since is None or table.anywhere:
        return []
    bits = serial.form(table).bits
    expected = content_of(evidence.case, table, bits, "serial", "expect", number)
    steps = []
    for at, write in enumerate(_written(evidence, table.from_, since)):
        wanted = expected[at] if at < len(expected) else None
        if write.value & (1 << bits) - 1 != wanted:
            right = "" if wanted is None else f", not {wanted:#04x}"
            what = f"SCITXBUF written, {write.value & 0xFF:#04x}: character {at} of the reply{right}"
            steps.append(evidence.step(write, f"{write.where}: {what}"))
    return steps[:MOST]


def _since(evidence: Evidence, serial: SerialTable, table: ExpectTable, asked: list[Record]) -> int | None:
    """Return the tick from which characters belong to the reply; None if the window does not contain it."""
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


def _written(evidence: Evidence, source: str, since: int) -> list[Record]:
    """Return the writes of SCITXBUF for the frames up to the end of the occurrence, in order."""
    unit, _, module = source.rpartition(".")
    found = []
    for frame in evidence.window.between(since, evidence.window.end - 1, Kind.FRAME):
        if frame.what == "begin":
            causes = (cause for cause, _ in evidence.walk(frame, 2))
            found += [r for r in causes if r.what == f"W {module}.SCITXBUF" and unit in ("", r.where)]
    return found
