"""Handling of frames that receivers may read either way: the frames of a line and the words that were received are
compared without the ambiguous parts.

    frames, rejected starts  --fit?-->  words to compare, one against one
    words received           ------->   ambiguous: frames with a glitch at a sample point

A glitch in a data, parity or stop bit leaves that bit open, so the word may have either value. A glitch in the start
bit, or a nearly valid start, leaves open whether a frame begins at all. A receiver that decides otherwise than the
decoder may read other frames up to the next pause. Comparison resumes at the place in the burst from which on most
words agree.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import NamedTuple

from ..traces.decode.uart import Event, Frame, Line, RejectedStart
from .compare import Happened, byte_words

LIKELY = Fraction(1, 4)  # minimum length, in bits, of a rejected start that a receiver may accept
AHEAD = 8  # number of words that must agree where comparison resumes
EXTRA = 2  # number of words that a receiver may read in addition to the frames


class Word(NamedTuple):
    """A received word. at: seconds since the capture began."""

    value: int
    frame_error: bool
    parity_error: bool
    at: Fraction

    @property
    def happened(self) -> Happened:
        return Happened(byte_words(self.value, self.frame_error, self.parity_error), self.at)


@dataclass
class Settled:
    """The result of `settled`. expected, found: the comparable parts. ambiguous: the omitted frames."""

    expected: list[Happened] = field(default_factory=list)
    found: list[Happened] = field(default_factory=list)
    ambiguous: list[Frame] = field(default_factory=list)


def settled(events: Sequence[Event], line: Line, rate: Fraction, found: Sequence[Word]) -> Settled:
    """Return the parts of a line that can be judged. rate: the number of positions in a second."""
    return _Settling(events, line, rate, found).result()


class _Settling:
    def __init__(self, events: Sequence[Event], line: Line, rate: Fraction, found: Sequence[Word]) -> None:
        self._line = line
        self._rate = rate
        self._found = found
        width = rate / Fraction(line.baud)
        self._items = [
            event
            for event in events
            if isinstance(event, Frame) or (isinstance(event, RejectedStart) and event.end - event.at >= LIKELY * width)
        ]
        self._pause = 2 * line.frame * width  # time from a start after which any reading of its frame is over

    def result(self) -> Settled:
        done = Settled()
        item = word = 0
        while item < len(self._items):
            event = self._items[item]
            if isinstance(event, Frame) and not event.unsure:
                self._compare(done, event, word)
                item, word = item + 1, word + 1
            elif isinstance(event, Frame) and not event.unsure & 1:
                if word < len(self._found) and self._fits(event, self._found[word]):
                    done.ambiguous.append(event)
                else:
                    self._compare(done, event, word)
                item, word = item + 1, word + 1
            else:
                frames, words = self._until_agreed(item, word)
                done.ambiguous += [one for one in self._items[item : item + frames] if isinstance(one, Frame)]
                item, word = item + frames, word + words
        done.found += [one.happened for one in self._found[word:]]
        return done

    def _compare(self, done: Settled, frame: Frame, word: int) -> None:
        words = byte_words(frame.value, frame.frame_error, frame.parity_error)
        done.expected.append(Happened(words, frame.at / self._rate))
        if word < len(self._found):
            done.found.append(self._found[word].happened)

    def _fits(self, frame: Frame, word: Word) -> bool:
        """Return True if a word is a possible reading of the frame."""
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
        """Return the numbers of items and of words to omit, from an unsure start to the best agreement in its burst.

        Of equally good agreements, choose the one with the fewest items, and then the one whose number of words is
        nearest to the usual number for these items.
        """
        usual = int(isinstance(self._items[item], Frame))
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
        """Return the number of next words that fit the next items, up to AHEAD.

        Return AHEAD also if the items and words end together, or if another unsure start is reached.
        """
        items, found = self._items[item : item + AHEAD], self._found[word : word + AHEAD]
        for number, event in enumerate(items):
            if not isinstance(event, Frame) or event.unsure & 1:
                return AHEAD
            if number == len(found) or not self._fits(event, found[number]):
                return number
        both_end = len(items) == len(self._found) - word
        return AHEAD if both_end else len(items)
