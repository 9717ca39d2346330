"""The RAM of one F28335, including the PIE vectors: 16-bit words and their wait states.

Words that were never written read 0. The words of L0 to L7 are allocated at the first write to one of them. Flash, OTP
and boot ROM are not included. For programs that are images of machine code, `processor.image.elsewhere` has them.

Source: SPRS439M Figure 3-2 (map), Table 3-5 (wait states); SPRUFB0D Tables 86 (EALLOW), 112 (vectors).
"""

# core: compiled

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, NamedTuple, final

from ...core.state import State
from ...form.c_types import UInt16
from ..pie.register_map import VECTOR_TABLE

MEMORY = "memory"  # in records of memory accesses, this name takes the place of the module's name
PAGE = 8  # `BY_PAGE` has an entry for each page of 2**PAGE addresses
IN_PAGE = (1 << PAGE) - 1
END = 0x1_0000  # all addresses of this memory are below this address
LOW_WORDS = 0x1000  # M0, M1 and the PIE vectors are below this address
HIGH, HIGH_WORDS = 0x8000, 0x8000  # first address and number of words of L0 to L7


class RamBlock(NamedTuple):
    """Block of memory. base, size: its address and length in words. protected: True if a write to it needs EALLOW."""

    name: str
    base: int
    size: int
    read_waits: int = 0
    write_waits: int = 0
    protected: bool = False


BLOCKS = (
    RamBlock("M0", 0x0000, 0x400),
    RamBlock("M1", 0x0400, 0x400),
    RamBlock("PIE vectors", VECTOR_TABLE.start, len(VECTOR_TABLE), read_waits=1, protected=True),
    *(RamBlock(f"L{n}", 0x8000 + 0x1000 * n, 0x1000) for n in range(8)),
)


BY_PAGE = tuple(
    next((block for block in BLOCKS if block.base <= page << PAGE < block.base + block.size), None)
    for page in range(END >> PAGE)
)


def block_at(address: int) -> RamBlock | None:
    """Return the block of memory that contains an address; None if there is none."""
    return BY_PAGE[address >> PAGE] if 0 <= address < END else None


@final
class Remainders:
    """Two remainders that stand for the contents of a memory, which are too many words to compare one by one.

    The contents are the coefficients of a polynomial: the place and the value of each word, or pair of words, that is
    not 0. It is evaluated modulo two prime numbers. Two different contents have equal remainders with a probability of
    about 2 ** -62.
    """

    __slots__ = ("_first", "_second")

    def __init__(self) -> None:
        self._first = self._second = 0

    def add(self, place: int, value: int) -> None:
        """Add a value that is not 0. Callers must add the values of a memory in the order of their places."""
        self._first = ((self._first * 65_599 + place) % (2**31 - 1) * 65_599 + value) % (2**31 - 1)
        self._second = ((self._second * 1_000_003 + place) % (2**31 - 19) * 1_000_003 + value) % (2**31 - 19)

    def both(self) -> tuple[int, int]:
        return self._first, self._second


@final
class HighRam:
    """The words of L0 to L7, which `Ram` allocates at the first write to one of them."""

    STATE = State("words", made=True)

    __slots__ = ("words",)

    words: Annotated[list[UInt16], HIGH_WORDS]

    def __init__(self) -> None:
        self.words = [0] * HIGH_WORDS

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """Return remainders in place of the words. See `proof.normal_state`."""
        found = Remainders()
        place: int
        for place in range(0, HIGH_WORDS, 2):
            pair: int = self.words[place]
            pair = pair << 16 | self.words[place + 1]
            if pair:
                found.add(place, pair)
        return {"words": found.both()}


@final
class Ram:
    """Words by address. Callers must only use addresses for which `block_at` returns a block."""

    STATE = State("_high _low")

    __slots__ = ("_high", "_low")

    _low: Annotated[list[UInt16], LOW_WORDS]

    def __init__(self) -> None:
        self._low = [0] * LOW_WORDS
        self._high: HighRam | None = None

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """Return remainders in place of the words. See `proof.normal_state`."""
        found = Remainders()
        place: int
        for place in range(LOW_WORDS):
            if self._low[place]:
                found.add(place, self._low[place])
        return {"_low": found.both()}

    def word(self, address: int) -> int:
        if address < HIGH:
            return self._low[address & LOW_WORDS - 1]
        return 0 if self._high is None else self._high.words[address & HIGH_WORDS - 1]

    def put(self, address: int, value: int) -> None:
        if address < HIGH:
            self._low[address & LOW_WORDS - 1] = value & 0xFFFF
            return
        if self._high is None:
            self._high = HighRam()
        self._high.words[address & HIGH_WORDS - 1] = value & 0xFFFF

    def words(self, address: int, count: int) -> list[int]:
        """Return `count` words from an address on."""
        return [self.word(place) for place in range(address, address + count)]

    def put_words(self, address: int, values: Sequence[int]) -> None:
        for offset, value in enumerate(values):
            self.put(address + offset, value)

    def word32(self, address: int) -> int:
        """Return the 32-bit value whose low word is at an even address. An odd address means the even one before it."""
        low = address & ~1
        return self.word(low) | self.word(low + 1) << 16

    def put_word32(self, address: int, value: int) -> None:
        low = address & ~1
        self.put(low, value)
        self.put(low + 1, value >> 16)
