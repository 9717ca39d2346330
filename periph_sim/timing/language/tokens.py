"""Words of a measure's or event's text, read one by one, with errors that say what was expected."""

from __future__ import annotations

import re

from ...core.phrases import did_you_mean, nearest
from .scope import BadEvent

WORD = re.compile(r"""\s*("[^"]+"|'[^']+'|["',=]|[^\s,="']+)""")


class Words:
    """The words of a text, taken one by one. place: the number of words taken so far."""

    def __init__(self, text: str) -> None:
        self.text = text
        self._words = WORD.findall(text)
        self.place = 0
        # `_optional` has a value of `place`, and the optional words that `took` did not find at this place.
        self._optional: tuple[int, list[str]] = (0, [])
        if '"' in self._words or "'" in self._words:
            raise BadEvent(f"{text!r}: a quote is not closed, or nothing is in it; write for instance 'time update'")

    @property
    def next(self) -> str:
        """The next word; "" at the end of the text."""
        return self._words[self.place] if self.place < len(self._words) else ""

    @property
    def following(self) -> str:
        """The word after the next word; "" if there is none."""
        return self._words[self.place + 1] if self.place + 1 < len(self._words) else ""

    @property
    def coming(self) -> list[str]:
        """The words after the next word."""
        return self._words[self.place + 1 :]

    def rest(self) -> str:
        """Take all remaining words and return them as one text."""
        begin, self.place = self.place, len(self._words)
        return self.between(begin)

    def take(self, expected: str) -> str:
        word = self.next
        if not word:
            raise BadEvent(f"{self.text!r} ends where {expected} is expected")
        self.place += 1
        return word

    def one_of(self, choices: list[str]) -> str:
        word = self.next
        if word not in choices:
            expected = " or ".join([", ".join(choices[:-1]), choices[-1]] if len(choices) > 1 else choices)
            if not word:
                raise BadEvent(f"{self.text!r} ends where {expected} is expected")
            hint = f"; {did_you_mean(word, choices)}" if len(choices) > 1 else ""
            raise BadEvent(f"{self.text!r}: {word!r} where {expected} is expected{hint}")
        self.place += 1
        return word

    def phrase(self, choices: list[str]) -> str:
        """Read one of these names, which may have several words, and return it. The longest name that fits is read."""
        for name in sorted(choices, key=len, reverse=True):
            count = len(name.split())
            if self._words[self.place : self.place + count] == name.split():
                self.place += count
                return name
        return self.one_of(choices)

    def took(self, word: str) -> bool:
        if self.next != word:
            self._optional = self.place, [*(self._optional[1] if self._optional[0] == self.place else ()), word]
            return False
        self.place += 1
        return True

    def name(self, expected: str) -> tuple[str, str]:
        """Read a name and return (unit, name). The unit is "" if the text does not contain one."""
        word = self.take(expected)
        unit, colon, name = word.partition(":")
        if word[0] in "\"'":
            return "", word[1:-1]
        if not colon:
            return "", word
        if not name:
            name = self.take(expected)  # a quoted name after the unit, such as imu: "my span"
            name = name[1:-1] if name[0] in "\"'" else name
        return unit, name

    def number(self, top: int) -> int | None:
        """Read a number up to `top` and return it. Raise BadEvent if the number is larger or misspelled.

        If the next word does not begin with a digit, read nothing and return None.
        """
        word = self.next
        if not word[:1].isdigit():
            return None
        try:
            number = int(word, 0)
        except ValueError:
            raise BadEvent(f"{self.text!r}: {word!r} is no number; write for instance 0x68") from None
        if number > top:
            raise BadEvent(f"{self.text!r}: {word} is more than it can be, {top:#x}")
        self.place += 1
        return number

    def address(self) -> int:
        """Read an I2C address and return it."""
        found = self.number(0x7F)
        if found is None:
            raise BadEvent(f"{self.text!r}: {self.next!r} where an address is expected; write for instance 0x68")
        return found

    def value(self) -> int:
        """Read and return the number after the sign =."""
        number = self.number(0xFFFFFFFF)
        if number is None:
            raise BadEvent(f"{self.text!r}: a number is expected after =")
        return number

    def between(self, begin: int) -> str:
        return " ".join(self._words[begin : self.place])

    def end(self) -> None:
        if self.next:
            place, optional = self._optional
            near = nearest(self.next, optional) if place == self.place else []
            if near:
                raise BadEvent(f"{self.text!r}: {self.next!r} where {near[0]} or the end is expected")
            raise BadEvent(f"{self.text!r}: {self.next!r} is more than a measure or event says; leave it out")


def name_text(unit: str, name: str) -> str:
    """Return a name as it is written in a measure, with its unit if one is given."""
    return f"{unit}:{name}" if unit else name
