"""The measures that a budget calls by a fixed name. Measures of events that users name are in `event`.

A measure is a row of MEASURES: which records it looks at, and what it takes of them. Who makes the records is in
`timing/derived`.
"""

from __future__ import annotations

from ...core.records import Kind
from ..budget_schema import REPLY, SPAN, WATCH
from .measure import READ, Measure
from .recorded import Row, Unknown
from .reply import Reply
from .span import SpanTime
from .watched_wire import WatchedWire

OTHER_FRAMES = "may carry frames that were not compared with them"

MEASURES = {
    "response": Row(
        "From the SCL fall that ends the ACK slot of a read address to the SCL rise of the first data bit.",
        Kind.TRANSFER,
        "answer",
        needs="I2C-A",
        occasion="read",
        asked="reads asked",
    ),
    "stretch": Row(
        "Longest time SCL was held low after the master had released it, per acknowledged phase, by any party.",
        Kind.TRANSFER,
        "stretch",
        needs="I2C-A",
        occurrence=READ,
        occasion="phase",
        asked="addressed phases asked",
        under_way="held",
        cut_off="SCL was still held low when the run ended",
    ),
    "round": Row(
        "From a round's begin to its last STOP. How late the controller itself begins is left out.",
        Kind.ROUND,
        "over",
        needs="rounds",
        occasion="due",
        asked="rounds due",
        nothing="no round was completed",
    ),
    "missed rounds": Row(
        "Rounds that did not begin while they were due, or that lack a request.",
        Kind.ROUND,
        "missed",
        takes="number",
        unit="count",
        needs="rounds",
        occasion="due",
        asked="rounds due",
        measured="due",
        required="due",
        unproven="no round was due",
    ),
    "nacked rounds": Row(
        "Rounds with at least one request whose address was not acknowledged.",
        Kind.ROUND,
        "refused",
        takes="number",
        unit="count",
        needs="rounds",
        occasion="due",
        asked="rounds due",
        measured="over",
        required="over",
        unproven="no round was completed",
    ),
    "nacked": Row(
        "Requests whose address was not acknowledged.",
        Kind.TRANSFER,
        "refused",
        takes="number",
        unit="count",
        needs="I2C-A",
    ),
    "wrong bytes": Row(
        "Bytes read that are not what they should be: `expect` of the request, or what a host frame makes them.",
        Kind.DATA,
        "wrong bytes",
        takes="sum",
        unit="bytes",
        needs="rounds",
        occasion="bytes asked",
        asked="bytes asked",
        measured="bytes compared",
        unknown=(
            Unknown("zeros", "byte", "read as 0 from chips that never showed a host frame's values"),
            Unknown("unknown bytes", "byte", "may be of frames that were not compared with them"),
        ),
    ),
    "age": Row(
        "From the end of the host frame whose values a read carries to the read's START.",
        Kind.DATA,
        "age",
        needs="host",
        occurrence=READ,
        occasion="chip read",
        asked="reads asked",
        unknown=(Unknown("unknown age", "read", OTHER_FRAMES),),
    ),
    "model age": Row(
        "From the end of the last host frame that was whole when the models began to every read of what they made.",
        Kind.DATA,
        "model age",
        needs="host",
        occurrence=READ,
        occasion="chip read",
        asked="reads asked",
        required="model run",
        nothing="no chip was read after a host frame had come",
        unproven="no span 'model' was over that began after a host frame had come",
    ),
    "fifo high-water": Row(
        "Most words that ever waited in the SCI receive FIFO.",
        Kind.RECEIVER,
        "words",
        unit="words",
        needs="SCI",
        occasion="character",
        asked="characters on RX",
        measured="received",
    ),
    "overruns": Row(
        "Characters lost in the SCI: FIFO overflow (RXFFOVF) or SCIRXBUF overrun (OE), counted as they happen.",
        Kind.RECEIVER,
        "lost",
        takes="number",
        unit="count",
        needs="SCI",
        occasion="character",
        asked="characters on RX",
        measured="received",
    ),
    "stuck": Row(
        "Times a line of the bus was held low longer than `stuck_after`.",
        Kind.BUS,
        "stuck",
        takes="number",
        unit="count",
        needs="I2C-A",
    ),
}
SLACK = Row(
    "From a round's last STOP to the moment at which the next round is due; negative where it came too late.",
    Kind.ROUND,
    "slack",
    needs="rounds",
    occasion="due",
    asked="rounds due",
    nothing="no round was completed",
)


def value_error(chips: str, at_frame: bool) -> Row:
    """Return the row of |value read - truth|, of the worst axis of each read of a chip after a host frame has come.

    chips: their names, as a phrase. at_frame: against the truth at the frame that fits best, which leaves out the age.
    """
    return Row(
        "Largest difference of an axis between a value read and the truth.",
        Kind.DATA,
        "value error at frame" if at_frame else "value error",
        unit="LSB",
        needs="host",
        occurrence=READ,
        occasion="sample",
        asked="reads asked",
        unknown=(Unknown("unknown error", "read", "may fit frames that were not compared with them"),),
        nothing=f"no sample of {chips} was read after a host frame had come",
    )


def make(name: str) -> Measure:
    """Return the measure of a name: one of MEASURES, "span:NAME", "reply:NAME", "watch:NAME". KeyError for others."""
    if name.startswith(REPLY):
        return Reply(name.removeprefix(REPLY))
    if name.startswith(SPAN):
        return SpanTime(name.removeprefix(SPAN))
    if name.startswith(WATCH):
        return WatchedWire(name.removeprefix(WATCH))
    return MEASURES[name].make()
