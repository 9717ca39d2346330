"""Errors that a UART line has in the capture itself: their share, and whether they make its format implausible.

A line that is read at a wrong rate, in a wrong format or inverted decodes into bytes with errors. A receiver with the
same settings reads the same bytes with the same errors, so agreement between capture and receiver proves nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from ..core.counted import counted
from ..traces.capture.capture import Capture
from ..traces.decode.uart import Break, Event, Frame, Line
from ..traces.decode.uart_guess import NEAR, Guess, guess

MOST = Fraction(1, 10)  # largest share of frames with errors that is plausible in the right format
SCI_BITS = 8  # maximum number of data bits of an SCI's word
SURE = 0.5  # minimum certainty of a guess that contradicts the format


@dataclass(frozen=True)
class LineErrors:
    """The errors of one channel.

    wrong: number of frames with a framing or parity error, except breaks and frames that a glitch makes ambiguous.
    frames: number of frames.
    doubt: a sentence that says why the channel has another format; empty if there is no evidence for this.
    """

    wrong: int
    frames: int
    doubt: str


def line_errors(capture: Capture, channel: str | int, line: Line, events: Sequence[Event]) -> LineErrors:
    """Return the errors of a channel that was decoded as `line`, with the doubt that they raise about that format."""
    frames = [event for event in events if isinstance(event, Frame)]
    breaks = {event.at for event in events if isinstance(event, Break)}
    breaks |= _break_at_end(capture, channel, line)
    wrong = sum((one.frame_error or one.parity_error) and not one.unsure and one.at not in breaks for one in frames)
    found = LineErrors(wrong, len(frames), "")
    better = _better(capture, channel, line, found) if wrong else None
    if better is None and wrong <= MOST * len(frames):
        return found
    advice = "expected few; check rate, format and polarity of the line" if better is None else _advice(better)
    return LineErrors(
        wrong,
        len(frames),
        f"read at {float(line.baud):g} baud, {line.shape}, {wrong} of {counted(len(frames), 'frame')} in the capture "
        f"({wrong / len(frames):.1%}) have framing or parity errors; {advice}",
    )


def _break_at_end(capture: Capture, channel: str | int, line: Line) -> set[int]:
    """Return the edge at which the line goes low for the rest of the capture: a break without its end."""
    wire = capture.channel(channel)
    if not len(wire.edges) or wire.levels[-1] != int(line.invert) or capture.rate is None:
        return set()
    last = int(wire.edges[-1])
    return {last} if capture.length - last >= line.frame * capture.rate / Fraction(line.baud) else set()


def _better(capture: Capture, channel: str | int, line: Line, found: LineErrors) -> Guess | None:
    """Return the format that the edges suggest, if it is another one with fewer errors; else None."""
    try:
        other = guess(capture, channel)
    except ValueError:
        return None
    many = found.wrong > MOST * found.frames
    same_rate = abs(Fraction(other.line.baud) / Fraction(line.baud) - 1) <= NEAR
    if same_rate and other.line.invert == line.invert:
        # The guess is not better if it is the same format, or has a ninth data bit, which takes bad stop bits as data.
        hides = other.line.shape == line.shape or other.line.bits > SCI_BITS
        if hides or not many:
            return None
    return other if other.sure >= SURE and other.errors < found.wrong / found.frames else None


def _advice(better: Guess) -> str:
    if better.line.invert:
        return (
            f"the line idles low, like an inverted one of {better.line.baud} baud, {better.line.shape}; "
            "capture it at the SCI's pin"
        )
    return (
        f"the line's edges fit {better.line.baud} baud, {better.line.shape}; if that is its format, give "
        f"--baud {better.line.baud} --format {better.line.shape}"
    )
