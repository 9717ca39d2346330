"""Separation of a UART capture's frames into those that can be judged and ambiguous ones.

    frames and rejected starts of the capture --+--> pairs of a frame and a word, which are compared
    words received by the firmware -------------+--> ambiguous frames: a glitch is at a sample point

A word is what the firmware received. A rejected start is a low pulse that the decoder found too short for a start bit.
An item is a decoded frame, or a rejected start that some receivers accept.

Receivers may read an ambiguous frame in different ways. If a glitch is in a data, parity or stop bit, this bit may be
read as 0 or 1. If a glitch is in the start bit, or the start bit is hardly long enough, a receiver may read a frame or
none. If the receiver decides differently from the decoder, it may also read different frames up to the next pause. The
comparison then skips some items and words. It resumes at the place after which the largest number of words agrees with
the items, but not later than at the first item after the pause.

If a line is decoded at a wrong rate, in a wrong format or inverted, frames have errors. A receiver with the same wrong
settings reads the same bytes with the same errors, so agreement between capture and receiver proves nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

from ..core.phrases import counted
from ..traces.capture.capture import Capture
from ..traces.decode.uart import Event, Line, UartRowKind
from ..traces.decode.uart_guess import NEAR, Guess, guess
from .report import Happened, byte_words

LIKELY = Fraction(1, 4)  # minimum length, in bits, of a low pulse that some receivers accept as a start bit
AHEAD = 8  # maximum number of words that are compared to find where the comparison resumes
EXTRA = 2  # maximum number of words, at each ambiguous place, that a receiver may read beyond the decoded frames
MOST = Fraction(1, 10)  # if a larger share of the frames has errors, the format is probably wrong
SCI_BITS = 8  # maximum number of data bits in a word of an SCI
SURE = 0.5  # minimum certainty (`Guess.sure`, 0 to 1) of a guessed format that makes the given format doubtful


class Word(NamedTuple):
    """A received word. at: the time at which the firmware read it, in seconds since the capture began."""

    value: int
    frame_error: bool
    parity_error: bool
    at: Fraction

    @property
    def happened(self) -> Happened:
        return Happened(byte_words(self.value, self.frame_error, self.parity_error), self.at)


class Settled:
    """Separates the frames and the received words that are judged from the ambiguous frames.

    events: the events of the decoded capture.
    line: the line format.
    rate: the number of positions per second in the capture.
    received: the words that the firmware received.

    expected, found: the frames of the capture and the received words that are judged. The replay agrees with the
        capture if they are equal.
    ambiguous: the frames that are not judged.
    """

    def __init__(self, events: Sequence[Event], line: Line, rate: Fraction, received: Sequence[Word]) -> None:
        self.expected: list[Happened] = []
        self.found: list[Happened] = []
        self.ambiguous: list[Event] = []
        self._line = line
        self._rate = rate
        self._received = received
        width = rate / Fraction(line.baud)
        self._items = [
            event
            for event in events
            if event.kind is UartRowKind.FRAME
            or (event.kind is UartRowKind.REJECTED and event.end - event.at >= LIKELY * width)
        ]
        # Minimum distance of two start bits, in positions, after which every receiver has finished the first frame.
        self._pause = 2 * line.frame * width
        item = word = 0
        while item < len(self._items):
            event = self._items[item]
            if event.kind is UartRowKind.FRAME and not event.unsure & 1:
                if event.unsure and word < len(received) and self._fits(event, received[word]):
                    self.ambiguous.append(event)
                else:
                    self._compare(event, word)
                item, word = item + 1, word + 1
            else:
                frames, words = self._until_agreed(item, word)
                self.ambiguous += [one for one in self._items[item : item + frames] if one.kind is UartRowKind.FRAME]
                item, word = item + frames, word + words
        self.found += [one.happened for one in received[word:]]

    def _compare(self, frame: Event, word: int) -> None:
        words = byte_words(frame.value, frame.frame_error, frame.parity_error)
        self.expected.append(Happened(words, frame.at / self._rate))
        if word < len(self._received):
            self.found.append(self._received[word].happened)

    def _fits(self, frame: Event, word: Word) -> bool:
        """Return True if a receiver may read the frame as this word."""
        data = (1 << self._line.bits) - 1
        open_data = frame.unsure >> 1 & data
        checked = self._line.parity != "none"
        open_parity = open_data or (checked and frame.unsure >> 1 + self._line.bits & 1)
        open_stop = frame.unsure >> 1 + self._line.bits + checked & 1
        return (
            not (frame.value ^ word.value) & ~open_data & data
            and (bool(open_parity) or frame.parity_error == word.parity_error)
            and (bool(open_stop) or frame.frame_error == word.frame_error)
        )

    def _until_agreed(self, item: int, word: int) -> tuple[int, int]:
        """Return how many items and words to skip from an uncertain start bit on: (items, words).

        An item is a decoded frame or a rejected start; a word is what the firmware received. The numbers are chosen so
        that the most words after them agree with the items after them. Of equally good pairs, the one with the fewest
        items is chosen, and then the one that skips nearest to one word per item. A rejected start at `item` does not
        count in this rule. If no pair makes any word agree, one item is skipped, with one word if it is a frame.

        item, word: the indices of the item with the uncertain start bit, and of the first word that is not compared.
        """
        usual = int(self._items[item].kind is UartRowKind.FRAME)
        last = item + 1
        while last < len(self._items) and self._items[last].at - self._items[last - 1].at < self._pause:
            last += 1
        best, most = (1, usual), 0
        for items in range(1, last - item + 1):
            likely = items - 1 + usual
            for words in sorted(range(likely + EXTRA + 1), key=lambda words: abs(words - likely)):
                agreeing = self._agreeing(item + items, word + words)
                if agreeing > most:
                    best, most = (items, words), agreeing
        return best

    def _agreeing(self, item: int, word: int) -> int:
        """Return how many words, from index `word` on, fit the items from index `item` on; at most AHEAD.

        The comparison ends at the first word that does not fit its item. It also ends before an item with an uncertain
        start bit, and where the items and the words end together. In these two cases, nothing contradicts the choice of
        `item` and `word`, so the result is AHEAD, the best possible one.
        """
        items, found = self._items[item : item + AHEAD], self._received[word : word + AHEAD]
        for number, event in enumerate(items):
            if event.kind is not UartRowKind.FRAME or event.unsure & 1:
                return AHEAD
            if number == len(found) or not self._fits(event, found[number]):
                return number
        both_end = len(items) == len(self._received) - word
        return AHEAD if both_end else len(items)


def line_errors(capture: Capture, channel: str | int, line: Line, events: Sequence[Event]) -> tuple[int, str]:
    """Return the errors of a channel that was decoded as `line`, and a doubt about this format.

    The errors are the number of frames with a framing or parity error, except breaks and frames that a glitch makes
    ambiguous. The doubt is a sentence with the evidence that the channel has another format; empty if there is none.
    """
    frames = [event for event in events if event.kind is UartRowKind.FRAME]
    breaks = {event.at for event in events if event.kind is UartRowKind.BREAK}
    breaks |= _break_at_end(capture, channel, line)
    wrong = sum((one.frame_error or one.parity_error) and not one.unsure and one.at not in breaks for one in frames)
    share = Fraction(wrong, max(1, len(frames)))
    better = _better(capture, channel, line, share) if wrong else None
    if better is None and share <= MOST:
        return wrong, ""
    advice = "expected few; check rate, format and polarity of the line" if better is None else _advice(better)
    return wrong, (
        f"read at {float(line.baud):g} baud, {line.shape}, {wrong} of {counted(len(frames), 'frame')} in the capture "
        f"({float(share):.1%}) have framing or parity errors; {advice}"
    )


def _break_at_end(capture: Capture, channel: str | int, line: Line) -> set[int]:
    """Return a set with the position of the last edge, if the line is low from there to the end for at least a frame.

    Such a low phase (high on an inverted line) is a break whose end was not captured. Otherwise, the set is empty.
    """
    wire = capture.channel(channel)
    if not len(wire.edges) or wire.levels[-1] != int(line.invert) or capture.rate is None:
        return set()
    last = int(wire.edges[-1])
    return {last} if capture.length - last >= line.frame * capture.rate / Fraction(line.baud) else set()


def _better(capture: Capture, channel: str | int, line: Line, share: Fraction) -> Guess | None:
    """Return the format guessed from the edges, if it is certain enough and has fewer errors than `line`; else None.

    A format with the rate and polarity of `line` is returned only if more than MOST of the frames have errors.

    share: the share of frames with errors in the format `line`.
    """
    try:
        other = guess(capture, channel)
    except ValueError:
        return None
    same_rate = abs(Fraction(other.line.baud) / Fraction(line.baud) - 1) <= NEAR
    if same_rate and other.line.invert == line.invert:
        # A format with nine data bits is rejected because it would hide framing errors: it counts a wrong stop bit as
        # a data bit.
        hides = other.line.shape == line.shape or other.line.bits > SCI_BITS
        if hides or share <= MOST:
            return None
    return other if other.sure >= SURE and other.errors < float(share) else None


def _advice(better: Guess) -> str:
    if better.line.invert:
        return (
            f"the line idles low, like an inverted one of {better.line.baud} baud, {better.line.shape}; "
            "capture it at the SCI's pin"
        )
    return (
        f"the line's edges fit {better.line.baud} baud, {better.line.shape}; if that is its format, give "
        f"--baud {better.line.baud} --frame {better.line.shape}"
    )
