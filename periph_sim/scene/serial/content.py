"""The characters of an entry of [serial], from text, bytes or a file, checked to fit the bits of a character."""

from __future__ import annotations

from ...core.input_files import read_input
from ..case.model import Case
from ..case.serial import SerialEntry

Place = tuple[str | int, ...]
LARGEST = 1 << 24  # maximum number of bytes: at 115200 baud they take 24 minutes


def content_of(case: Case, entry: SerialEntry, bits: int, *place: str | int) -> bytes:
    """Return the characters of an entry of [serial].

    Raise BadCase, with its line, if a character has more than `bits` bits, if a file is empty or cannot be read, or if
    a text cannot be encoded.
    """
    if entry.text is not None:
        return _fitting(case, encoded(case, entry.text, entry, *place, "text"), bits, *place, "text")
    if entry.data is not None:
        return _fitting(case, entry.data, bits, *place, "bytes")
    if entry.file is not None:
        return _fitting(case, _read(case, entry.file, *place, "file"), bits, *place, "file")
    return b""


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


def _fitting(case: Case, data: bytes, bits: int, *place: str | int) -> bytes:
    wide = next((byte for byte in data if byte >> bits), None)
    if wide is not None:
        what = f"{wide:#04x} does not fit a character of {bits} bits; give other content, or more bits"
        raise case.mistake(what, *place)
    return data


def show_characters(characters: tuple[int, ...], as_text: bool) -> str:
    """Return characters as text for messages, such as 'OK\\r\\n' or 06 15.

    A character with a value above 0xFF was received with an error. It is followed by an exclamation mark: 06!.
    """
    bad = any(value > 0xFF for value in characters)
    if as_text and not bad and all(value < 0x80 for value in characters):
        return repr(bytes(characters))[1:]
    return " ".join(f"{value & 0xFF:02x}{'!' if value > 0xFF else ''}" for value in characters)
