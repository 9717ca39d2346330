"""Settings with which firmware answers like the captured target, from the target's turns.

    turns of one address --> address, replies, asleep, busy

A run of refused addresses becomes a time in which the firmware does not answer: from the STOP of the write before it,
or from the start, up to the middle between the last NACK and the START of the first turn that was answered.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction

from .i2c_script import Turn


@dataclass
class AsTarget:
    """The settings of firmware that plays a captured target. Times are in positions of the capture."""

    address: int
    replies: list[bytes] = field(default_factory=list)  # one for each read
    asleep: Fraction | None = None  # the firmware does not answer from the start up to this time
    busy: list[Fraction] = field(default_factory=list)  # times without answers after each write that a STOP ended
    refused: int = 0  # number of NACKs that neither `asleep` nor `busy` can reproduce


def as_target(address: int, turns: Iterable[Turn], end: int) -> AsTarget:
    """Return the settings for one address. end: the position at which NACKs at the end of the capture are over."""
    found = AsTarget(address)
    refused: list[Turn] = []
    last: Turn | None = None  # the last answered turn
    for turn in turns:
        if turn.address != address:
            continue
        if not turn.answer.ack:
            refused.append(turn)
            continue
        if refused:
            _out_of_reach(found, last, refused, Fraction(refused[-1].answered + turn.begin, 2))
            refused = []
        last = turn
        if turn.read:
            found.replies.append(turn.answer.data)
        elif turn.stop is not None:
            found.busy.append(Fraction(0))
    if refused:
        _out_of_reach(found, last, refused, Fraction(end))
    return found


def _out_of_reach(found: AsTarget, after: Turn | None, refused: list[Turn], until: Fraction) -> None:
    if after is None:
        found.asleep = until
    elif not after.read and after.stop is not None:
        found.busy[-1] = until - after.stop
    else:
        found.refused += len(refused)
