"""The instruction set as data: `encodings.toml` goes in; patterns with their fields and properties come out.

    bits    1100110xllllllll cccccccccccccccc      first word first, most significant bit first
    fields  x = 0, l = 0x41, c = 0x00FF            of a given pair of words

A pattern of one word is matched against the upper half of (first word << 16 | second word), so that a field lies at the
same place whatever the length.

Source: SPRU430F chapters 2, 4 to 6; SPRUEO2A. The head of `encodings.toml` says what its columns mean.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import NamedTuple

PAIR = 32  # bits of the two words that a pattern is matched against


class BitField(NamedTuple):
    """Where a field lies within the two words, first word first."""

    shift: int
    mask: int  # at bit 0

    def of(self, pair: int) -> int:
        return pair >> self.shift & self.mask


@dataclass(frozen=True, eq=False, slots=True)
class Encoding:
    """One form of an instruction.

    mask, value: of the fixed bits within the two words. at_least, at_most: bounds of fields that belong to the pattern.
    objmode: "1", "0" or "X" for both. kind: core, fpu, c2xlp, c27x, emu or trap. alias_of: the form whose operand field
    has this one as a value. shift_bias: what field s lacks of the shift it stands for. latency: "2p" of a result that
    is there one instruction later; "2p/1", "2p/2p" of the halves of a pair; else "".
    """

    id: str
    mnemonic: str
    syntax: str
    words: int
    mask: int
    value: int
    fields: Mapping[str, BitField]
    at_least: tuple[tuple[str, int], ...]
    at_most: tuple[tuple[str, int], ...]
    objmode: str
    kind: str
    alias_of: str
    shift_bias: int
    repeatable: bool
    cycles: int
    not_taken: int
    latency: str
    flags: str
    reads: tuple[str, ...]
    writes: tuple[str, ...]
    op: str

    def matches(self, pair: int) -> bool:
        """True if these two words are this form; the second one counts only where the form has it."""
        return (
            pair & self.mask == self.value
            and all(self.fields[name].of(pair) >= least for name, least in self.at_least)
            and all(self.fields[name].of(pair) <= most for name, most in self.at_most)
        )

    def values(self, pair: int) -> dict[str, int]:
        """The number in each field."""
        return {name: place.of(pair) for name, place in self.fields.items()}

    def pair(self, values: Mapping[str, int]) -> int:
        """The two words with these numbers in the fields; a bit that may have any value is 0."""
        pair = self.value
        for name, number in values.items():
            place = self.fields[name]
            if number & ~place.mask:
                raise ValueError(f"{number} does not fit field {name!r} of {self.id}, at most {place.mask}")
            pair |= number << place.shift
        return pair

    @property
    def accesses(self) -> str:
        """What it does at the address of its operand field: "", "r", "w" or "rw"."""
        read = any(place.partition("@")[0] in LOCATIONS for place in self.reads)
        written = any(place.partition("@")[0] in LOCATIONS for place in self.writes)
        return "r" * read + "w" * written


LOCATIONS = ("loc16", "loc32", "mem16", "mem32")


@cache
def encodings() -> tuple[Encoding, ...]:
    """Every form, in the order of the table."""
    text = resources.files(__package__).joinpath("encodings.toml").read_text(encoding="utf-8")
    return tuple(_encoding(row) for row in tomllib.loads(text)["encoding"])


@cache
def by_id() -> dict[str, Encoding]:
    return {encoding.id: encoding for encoding in encodings()}


def _encoding(row: Mapping[str, object]) -> Encoding:
    bits = str(row["bits"]).ljust(PAIR, ".")
    mask = int("".join("01"[bit in "01"] for bit in bits), 2)
    value = int("".join("01"[bit == "1"] for bit in bits), 2)
    at_least, at_most = _bounds(str(row.get("where", "")))
    cycles = int(str(row["cycles"]))
    return Encoding(
        id=str(row["id"]),
        mnemonic=str(row["mnemonic"]),
        syntax=str(row["syntax"]),
        words=int(str(row["words"])),
        mask=mask,
        value=value,
        fields=_fields(bits),
        at_least=at_least,
        at_most=at_most,
        objmode=str(row["objmode"]),
        kind=str(row["class"]),
        alias_of=str(row.get("alias_of", "")),
        shift_bias=int(str(row.get("field", "")).startswith("s is shift-1")),
        repeatable=row["rpt"] is True,
        cycles=cycles,
        not_taken=int(str(row.get("not_taken", cycles))),
        latency=str(row.get("latency", "")),
        flags=str(row["flags"]),
        reads=_names(row["reads"]),
        writes=_names(row["writes"]),
        op=str(row["op"]),
    )


def _names(listed: object) -> tuple[str, ...]:
    assert isinstance(listed, list)
    return tuple(str(name) for name in listed)


def _fields(bits: str) -> dict[str, BitField]:
    fields = {}
    for name in sorted(set(bits) - set("01.")):
        first, last = bits.index(name), bits.rindex(name)
        if bits[first : last + 1] != name * (last - first + 1):
            raise ValueError(f"field {name!r} of {bits} is in two pieces")
        fields[name] = BitField(PAIR - 1 - last, (1 << (last - first + 1)) - 1)
    return fields


def _bounds(where: str) -> tuple[tuple[tuple[str, int], ...], tuple[tuple[str, int], ...]]:
    """The bounds that "s >= 1" or "n <= 5" states: (at least, at most)."""
    if not where:
        return (), ()
    name, relation, number = where.split()
    bound = ((name, int(number)),)
    if relation == ">=":
        return bound, ()
    if relation == "<=":
        return (), bound
    raise ValueError(f"{where!r} states no bound of a field")
