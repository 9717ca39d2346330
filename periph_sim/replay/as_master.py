"""Settings with which firmware repeats the captured controller: a script from its transfers.

    transfers --> "50 W 00 Sr 50 R 6", the pause before it, the targets' answers with their stretches
              --> or why the F28335 cannot do that as master

The lines do not show who held SCL low: a low phase much longer than usual counts as the target's, where a target may
stretch, that is from the address's ACK on.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field, replace
from fractions import Fraction

from ..bus.i2c.scripted_target import Answer
from ..traces.decode.i2c import Byte, Phase, Transfer
from .i2c_script import is_addressed, turns
from .i2c_setup import Played

CUT = "the capture, or its known part, ends before their STOP"
BROKEN = "the controller broke off a byte with a repeated START or STOP"
EMPTY = "START without an address byte"
NO_DATA = "a read of no byte, whose address was acknowledged"
AGAINST = "the controller continued after a NACK"


@dataclass
class AsMaster:
    """The settings of firmware that plays the controller, and the targets' answers.

    script, pauses: one entry for each transfer in `done`; pauses are in positions.
    done: the transfers in the script.
    answers: the answers of the targets, indexed by their addresses.
    left_out: the number of omitted transfers for each reason.
    """

    script: list[str] = field(default_factory=list)
    pauses: list[Fraction] = field(default_factory=list)
    done: list[Transfer] = field(default_factory=list)
    answers: dict[int, list[Answer]] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)


def as_master(part: Played, ticks_per_position: Fraction) -> AsMaster:
    """Return the script, and the targets' answers to it."""
    found = AsMaster()
    over: int | None = None
    for transfer in part.transfers:
        why = obstacle(transfer)
        if why:
            found.left_out[why] = found.left_out.get(why, 0) + 1
            continue
        begin = transfer.phases[0].start.at
        found.pauses.append(Fraction(begin if over is None else begin - over))
        over = None if transfer.stop is None else transfer.stop.at
        found.script.append(" Sr ".join(_text(phase) for phase in transfer.phases))
        found.done.append(transfer)
    found.answers = stretched_answers(found.done, part.long_low, ticks_per_position)
    return found


def stretched_answers(
    transfers: list[Transfer], long_low: Fraction, ticks_per_position: Fraction
) -> dict[int, list[Answer]]:
    """Return the targets' answers with their stretches, indexed by address.

    long_low: the limit, in positions, above which a low phase of SCL is a stretch.
    """
    answers: dict[int, list[Answer]] = defaultdict(list)
    phases = [phase for transfer in transfers for phase in transfer.phases if is_addressed(phase)]
    for phase, turn in zip(phases, turns(transfers), strict=True):
        stretches = _stretches(phase, long_low, ticks_per_position)
        answers[turn.address].append(replace(turn.answer, stretches=stretches))
    return answers


def obstacle(transfer: Transfer) -> str:
    """Return why the F28335 as master cannot do a transfer; empty if it can."""
    if transfer.stop is None:
        return CUT
    for phase in transfer.phases:
        if not phase.bytes:
            return EMPTY
        if any(byte.acked is False for byte in phase.bytes[:-1]):
            return AGAINST
        if any(byte.acked is None for byte in phase.bytes):
            return BROKEN
        if phase.read and len(phase.bytes) == 1 and phase.bytes[0].acked:
            return NO_DATA
    return ""


def _text(phase: Phase) -> str:
    assert phase.address is not None
    data = phase.data
    if phase.read:
        return f"{phase.address:02X} R {len(data)}" + (" ACK" if data and phase.bytes[-1].acked else "")
    return " ".join([f"{phase.address:02X} W", *(f"{byte:02X}" for byte in data)])


def _stretches(phase: Phase, long_low: Fraction, ticks_per_position: Fraction) -> tuple[tuple[int, int, int], ...]:
    found = []
    for number, byte in enumerate(phase.bytes, -1):
        for place, low in _lows(byte):
            if (number >= 0 or place == 8) and low > long_low:
                found.append((number, place, int(low * ticks_per_position)))
    return tuple(found)


def _lows(byte: Byte) -> list[tuple[int, int]]:
    return [(place, bit.low) for place, bit in enumerate(byte.bits) if bit.low is not None]
