"""The serial tables of a case: data that is sent to SCIs from outside, and replies that must follow in time.

[serial] ------------ rate and format of characters, unless an entry has its own
[[serial.send]] ----- data to send, the receiving SCI, and the time; `expect = "nothing"` is a budget silence:NAME
[[serial.expect]] --- a reply, the sending SCI, and the time limit; judged as a budget of the measure reply:NAME
"""

from __future__ import annotations

from collections.abc import Set
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any, Literal

from msgspec import Meta, field

from ...bus.uart.frame_format import UartFormat
from ...core.input_files import read_input
from ...core.table import Duration, HexBytes, Table
from .scalars import Byte, Length, Ppm

if TYPE_CHECKING:
    from .model import Case

Baud = Annotated[int, Meta(ge=1, le=10_000_000)]
DataBits = Annotated[int, Meta(ge=1, le=8)]
StopBits = Literal[1, 2]
Parity = Literal["none", "even", "odd"]
Multiprocessor = Literal["none", "idle-line", "address-bit"]
Encoding = Literal["ascii", "latin-1", "utf-8"]
Times = Annotated[int, Meta(ge=1)]
Places = tuple[Annotated[int, Meta(ge=0)], ...]

LARGEST = 1 << 24  # maximum number of bytes of a file: at 115200 baud they take 24 minutes
FORMAT = ("bits", "parity", "stop", "multiprocessor")
UNITS = (("s", 1), ("ms", 10**3), ("us", 10**6), ("ns", 10**9))
NAMES = {"data": "bytes", "low": "break"}  # maps a field to its key in a file, for fields whose key has another name


class SerialEntry(Table, frozen=True, kw_only=True):
    r"""The keys that sends and expected replies have in common: content, trigger, rate and format.

    text: the characters as text, with TOML escapes: `"\r\n"`
    bytes: the characters as bytes
    file: a file with the bytes
    encoding: encoding of texts: `"ascii"`, `"latin-1"` or `"utf-8"`
    at: time from the start of the run
    after: event that triggers the entry: `"edge READY rise"`, `"frame TX 0x06"`
    baud, bits, parity, stop, multiprocessor: replace those of `[serial]`
    """

    text: str | None = None
    data: HexBytes | None = field(default=None, name="bytes")
    file: str | None = None
    encoding: Encoding = "ascii"
    at: Duration | None = None
    after: str | None = None
    baud: Baud | None = None
    bits: DataBits | None = None
    parity: Parity | None = None
    stop: StopBits | None = None
    multiprocessor: Multiprocessor | None = None

    def check_only_one(self, what: str, *keys: str) -> None:
        """Raise ValueError unless exactly one of these keys is given."""
        said = [NAMES.get(key, key) for key in keys]
        given = [NAMES.get(key, key) for key in keys if getattr(self, key) is not None]
        if not given:
            raise ValueError(f"{what} needs one of {', '.join(said[:-1])} and {said[-1]}")
        if len(given) > 1:
            raise ValueError(f"{' and '.join(given)} cannot both be; leave one of them out")

    def check_content(self, *keys: str) -> None:
        """Raise ValueError if the content of one of these keys is empty."""
        for key in keys:
            if getattr(self, key) is not None and not getattr(self, key):
                raise ValueError(f"{NAMES.get(key, key)} is empty; write at least one character")


class SendTable(SerialEntry, frozen=True, kw_only=True):
    """Characters to send: exactly one of `text`, `bytes`, `file` and `break`.

    The time is exactly one of `at`, `after`, `after_text` and `after_bytes`. A send begins when earlier sends
    on its line are over. Characters of units on an RS-485 pair do not delay it.

    name: name in messages, in `after_send` and in `--set`
    to: receiving SCI: `"dsp.SCI-A"`, or `"SCI-A"` if one unit has it
    break: time the line is held low
    address: address character, sent first. `multiprocessor` determines how it is marked: by address bit 1, or by 11 or
        more idle bits after earlier sends on its line
    after_text, after_bytes: characters from the SCI that trigger the send
    delay: time from the event to the first start bit
    period: time between repetitions after the first event
    times: maximum number of sends; `"all"` for no limit. If omitted: no limit with `period`, 1 without it
    gap: idle time between characters
    wrong_parity: characters sent with wrong parity, numbered from 0, address included
    missing_stop: characters with low stop bits; an idle bit follows
    ppm: clock error of this send; replaces that of `[serial]`
    expect, within: `"nothing"`: the SCI must send nothing from the start of the send until this time after its end, or
        until other data is sent or another reply is expected. This is a budget of the send's name with the measure
        `silence:NAME`
    """

    name: str | None = None
    to: str
    low: Length | None = field(default=None, name="break")
    address: Byte | None = None
    after_text: str | None = None
    after_bytes: HexBytes | None = None
    delay: Duration = Fraction(0)
    period: Length | None = None
    times: Times | Literal["all"] | None = None
    gap: Duration = Fraction(0)
    wrong_parity: Places = ()
    missing_stop: Places = ()
    ppm: Ppm | None = None
    expect: Literal["nothing"] | None = None
    within: Length | None = None

    def check_together(self, given: Set[str]) -> None:
        self.check_only_one("a send", "text", "data", "file", "low")
        self.check_only_one("a send", "at", "after", "after_text", "after_bytes")
        self.check_content("text", "data", "after_text", "after_bytes")
        if self.times is not None and self.at is not None and self.period is None:
            raise ValueError("times needs period, since a time comes once; give period, or leave times out")
        if self.low is not None and (self.address is not None or self.wrong_parity or self.missing_stop):
            raise ValueError("a break has no characters; send them apart")
        if (self.expect is None) != (self.within is None):
            raise ValueError(
                'expect = "nothing" and within belong together; give both, or expect a reply by [[serial.expect]]'
            )
        if self.expect is not None and self.name is None:
            raise ValueError("a send that expects nothing is a budget; give it a name")


class ExpectTable(SerialEntry, frozen=True, kw_only=True):
    """A reply that an SCI must send: exactly one of `text`, `bytes` and `file`, after one of `after_send`, `after` and
    `at`.

    Each entry makes a budget, which has the name of the entry and the measure `reply:NAME`. A different or missing
    reply breaks it. If the reply never becomes due, the budget is not judged.

    name: name, distinct from those of budgets
    from: sending SCI, written as in `to`
    after_send: name of a send. Each time it is sent, a reply is expected. The reply may begin during the send, as an
        echo does; its time counts from the end of the send
    within: time limit for the end of the last character; takes the place of `max`, also in `--set`. A limit
        that no reply can keep is rejected: the characters must not take longer than `within`, or, with `after_send`,
        than the send and `within` together
    anywhere: `true`: other characters may precede the reply
    why: reason, shown with the verdict
    """

    name: str
    from_: str = field(name="from")
    after_send: str | None = None
    within: Length
    anywhere: bool = False
    why: str = ""

    def check_together(self, given: Set[str]) -> None:
        self.check_only_one("an expect", "text", "data", "file")
        self.check_only_one("an expect", "after_send", "after", "at")
        self.check_content("text", "data")


class SerialTable(Table, frozen=True, kw_only=True):
    """Sends characters to SCIs and checks replies. Rate and format do not follow the registers of the SCI.

    baud: bits per second
    bits: data bits, 1 to 8
    parity: `"none"`, `"even"` or `"odd"`
    stop: stop bits, 1 or 2
    multiprocessor: `"none"`, `"address-bit"` or `"idle-line"`
    ppm: clock error, parts per million
    turnaround: time an RS-485 pair stays driven after the last stop bit
    send: characters to send, `[[serial.send]]`
    expect: expected replies, `[[serial.expect]]`
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

    def value(self, key: str, entry: SerialEntry | None = None) -> Any:
        """Return the value of a key in `entry`, or in this table if no entry is given or the entry lacks the key."""
        own = getattr(entry, key, None)
        return getattr(self, key) if own is None else own

    def form(self, entry: SerialEntry | None = None) -> UartFormat:
        """Return the character format of an entry, or of this table if no entry is given."""
        bits, parity, stop, mode = (self.value(key, entry) for key in FORMAT)
        return UartFormat(bits, parity, stop, mode == "address-bit")

    def bit(self, entry: SerialEntry | None = None) -> Fraction:
        """Return, in seconds, the nominal bit length of `entry`, or of this table if no entry is given."""
        return Fraction(1, self.value("baud", entry))


def in_words(length: Fraction) -> str:
    """Return a duration, given in seconds, as text for a case, such as "250 us".

    The unit is the largest one that gives a whole number; if there is none, the unit is the second.
    """
    symbol, number = next(
        ((symbol, length * size) for symbol, size in UNITS if (length * size).denominator == 1), ("s", length)
    )
    return f"{number} {symbol}"


def content_of(case: Case, entry: SerialEntry, bits: int, *place: str | int) -> bytes:
    """Return the characters of an entry of [serial] from its key `text`, `bytes` or `file`; b"" if it has none.

    bits: the number of data bits of a character. place: the keys that lead to the entry, for messages.

    Raise BadCase if a character has more bits, if a file is empty or cannot be read, or if a text cannot be encoded.
    """
    data, key = entry.data or b"", "bytes"
    if entry.text is not None:
        data, key = encoded(case, entry.text, entry, *place, "text"), "text"
    elif entry.file is not None:
        data, key = _read(case, entry.file, *place, "file"), "file"
    wide = next((byte for byte in data if byte >> bits), None)
    if wide is not None:
        what = f"{wide:#04x} does not fit a character of {bits} bits; give other content, or more bits"
        raise case.mistake(what, *place, key)
    return data


def encoded(case: Case, text: str, entry: SerialEntry, *place: str | int) -> bytes:
    """Return a text in the encoding of its entry. Raise BadCase for a character that cannot be encoded."""
    try:
        return text.encode(entry.encoding)
    except UnicodeEncodeError as error:
        wrong = text[error.start : error.end]
        what = f"{wrong!r} cannot be encoded in {entry.encoding}; give another encoding, or bytes instead of text"
        raise case.mistake(what, *place) from None


def _read(case: Case, name: str, *place: str | int) -> bytes:
    path = case.folder / name
    try:
        data = read_input(path, LARGEST)
    except OSError as error:
        what = f"{name} cannot be read ({error.strerror}); a path counts from the folder of the case"
        raise case.mistake(what, *place) from None
    if not data:
        raise case.mistake(f"{name} is empty; it needs at least one character", *place)
    return data


def show_characters(characters: tuple[int, ...], as_text: bool) -> str:
    """Return characters as text for messages, such as 'OK\\r\\n' or 06 15.

    A character with a value above 0xFF was received with an error. It is followed by an exclamation mark: 06!.
    """
    bad = any(value > 0xFF for value in characters)
    if as_text and not bad and all(value < 0x80 for value in characters):
        return repr(bytes(characters))[1:]
    return " ".join(f"{value & 0xFF:02x}{'!' if value > 0xFF else ''}" for value in characters)
