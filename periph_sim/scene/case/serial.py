"""The serial tables of a case: data that is sent to SCIs from outside, and replies that must follow in time.

[serial] ------------ rate and format of characters, unless an entry has its own
[[serial.send]] ----- data to send, the receiving SCI, and the time
[[serial.expect]] --- a reply, the sending SCI, and the time limit; judged as a budget of the measure reply:NAME
"""

from __future__ import annotations

from collections.abc import Set
from fractions import Fraction
from typing import Annotated, Literal

from msgspec import Meta, field

from ...bus.uart.frame_format import UartFormat
from ...core.settings import Duration, HexBytes
from ...core.table import Table
from ...timing.budget_schema import REPLY, Budget
from .scalars import Byte, Length, Ppm

Baud = Annotated[int, Meta(ge=1, le=10_000_000)]
DataBits = Annotated[int, Meta(ge=1, le=8)]
StopBits = Literal[1, 2]
Parity = Literal["none", "even", "odd"]
Multiprocessor = Literal["none", "idle-line", "address-bit"]
Encoding = Literal["ascii", "latin-1", "utf-8"]
Times = Annotated[int, Meta(ge=1)]
Places = tuple[Annotated[int, Meta(ge=0)], ...]

FORMAT = ("bits", "parity", "stop")
UNITS = (("s", 1), ("ms", 10**3), ("us", 10**6), ("ns", 10**9))


def _only_one(table: Table, what: str, keys: tuple[str, ...], names: tuple[str, ...] = ()) -> None:
    """Raise ValueError unless exactly one of these keys is given. names: their names in a file, if they differ."""
    said = names or keys
    given = [name for key, name in zip(keys, said, strict=True) if getattr(table, key) is not None]
    if not given:
        raise ValueError(f"{what} needs one of {', '.join(said[:-1])} and {said[-1]}")
    if len(given) > 1:
        raise ValueError(f"{' and '.join(given)} cannot both be; leave one of them out")


class SendTable(Table, frozen=True, kw_only=True):
    """Data to send to an SCI. wrong_parity, missing_stop: numbers, from 0, of the characters sent with this error."""

    name: str | None = None
    to: str
    text: str | None = None
    data: HexBytes | None = field(default=None, name="bytes")
    file: str | None = None
    low: Length | None = field(default=None, name="break")
    encoding: Encoding = "ascii"
    address: Byte | None = None
    at: Duration | None = None
    after: str | None = None
    after_text: str | None = None
    after_bytes: HexBytes | None = None
    delay: Duration = Fraction(0)
    period: Length | None = None
    times: Times | Literal["all"] | None = None
    gap: Duration = Fraction(0)
    wrong_parity: Places = ()
    missing_stop: Places = ()
    baud: Baud | None = None
    bits: DataBits | None = None
    parity: Parity | None = None
    stop: StopBits | None = None
    multiprocessor: Multiprocessor | None = None
    ppm: Ppm | None = None

    def check_together(self, given: Set[str]) -> None:
        _only_one(self, "a send", ("text", "data", "file", "low"), ("text", "bytes", "file", "break"))
        _only_one(self, "a send", ("at", "after", "after_text", "after_bytes"))
        for key, name in (("text", "text"), ("data", "bytes"), ("after_text", "after_text"), ("after_bytes",) * 2):
            if getattr(self, key) is not None and not getattr(self, key):
                raise ValueError(f"{name} is empty; write at least one character")
        if self.times is not None and self.at is not None and self.period is None:
            raise ValueError("times needs period, since a time comes once; give period, or leave times out")
        if self.low is not None and (self.address is not None or self.wrong_parity or self.missing_stop):
            raise ValueError("a break has no characters; send them apart")


class ExpectTable(Table, frozen=True, kw_only=True):
    """A reply that an SCI must send. anywhere: True if other characters may come before it."""

    name: str
    from_: str = field(name="from")
    text: str | None = None
    data: HexBytes | None = field(default=None, name="bytes")
    file: str | None = None
    encoding: Encoding = "ascii"
    after_send: str | None = None
    after: str | None = None
    at: Duration | None = None
    within: Length
    anywhere: bool = False
    baud: Baud | None = None
    bits: DataBits | None = None
    parity: Parity | None = None
    stop: StopBits | None = None
    multiprocessor: Multiprocessor | None = None
    why: str = ""

    def check_together(self, given: Set[str]) -> None:
        _only_one(self, "an expect", ("text", "data", "file"), ("text", "bytes", "file"))
        _only_one(self, "an expect", ("after_send", "after", "at"))
        for key, name in (("text", "text"), ("data", "bytes")):
            if getattr(self, key) is not None and not getattr(self, key):
                raise ValueError(f"{name} is empty; write at least one character")


class SerialTable(Table, frozen=True, kw_only=True):
    """The outside parties that exchange characters with SCIs.

    ppm: error of the clock by which all their times and rates are counted.
    turnaround: the time for which they keep driving an RS-485 pair after their last stop bit.
    """

    baud: Baud = 115_200
    bits: DataBits = 8
    parity: Parity = "none"
    stop: StopBits = 1
    multiprocessor: Multiprocessor = "none"
    ppm: Ppm = Fraction(0)
    turnaround: Duration = Fraction(0)
    send: tuple[SendTable, ...] = ()
    expect: tuple[ExpectTable, ...] = ()

    def mode(self, entry: SendTable | ExpectTable | None = None) -> Multiprocessor:
        """Return the multiprocessor mode of an entry, or of this table if the entry has none or is not given."""
        return self.multiprocessor if entry is None or entry.multiprocessor is None else entry.multiprocessor

    def form(self, entry: SendTable | ExpectTable | None = None) -> UartFormat:
        """Return the character format of an entry, or of this table if no entry is given."""
        own = {} if entry is None else {key: getattr(entry, key) for key in FORMAT}
        bits, parity, stop = (getattr(self, key) if own.get(key) is None else own[key] for key in FORMAT)
        return UartFormat(bits, parity, stop, self.mode(entry) == "address-bit")

    def bit(self, entry: SendTable | ExpectTable | None = None) -> Fraction:
        """Return the nominal bit length of an entry, in seconds, or of this table if no entry is given."""
        baud = self.baud if entry is None or entry.baud is None else entry.baud
        return Fraction(1, baud)

    def clock(self, entry: SendTable | ExpectTable | None = None) -> Fraction:
        """Return the clock error of an entry, in parts per million, or of this table if the entry has none."""
        own = entry.ppm if isinstance(entry, SendTable) else None
        return self.ppm if own is None else own


def with_replies(budgets: tuple[Budget, ...], serial: SerialTable | None) -> tuple[Budget, ...]:
    """Return the budgets of a case, and one more for each expected reply that has no budget of its name."""
    expected = () if serial is None else serial.expect
    known = {(budget.name, budget.measure) for budget in budgets}
    return budgets + tuple(reply_budget(one) for one in expected if (one.name, REPLY + one.name) not in known)


def reply_budget(expected: ExpectTable) -> Budget:
    return Budget(name=expected.name, measure=REPLY + expected.name, max=in_words(expected.within), why=expected.why)


def in_words(length: Fraction) -> str:
    """Return a duration as text for a case, in the largest unit that gives a whole number; if none does, in seconds."""
    symbol, number = next(
        ((symbol, length * size) for symbol, size in UNITS if (length * size).denominator == 1), ("s", length)
    )
    return f"{number} {symbol}"
