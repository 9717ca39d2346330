"""The `.psr` file format of periph-sim: a run or a capture as typed columns, stored without any loss.

    RecordTable, Capture --> write_table, write --> zip of numpy arrays --> read_table, read

A file is a zip whose members are .npy arrays, so that `numpy.load` can open the file. The members are:

    head.npy     UTF-8 bytes of a JSON object: format, version, ticks_per_second, end, names, topics, modules, clocks,
                 capture
    number.npy   tick.npy    the differences from the previous record; for the first record the values themselves
    topic.npy    indices into `topics` of the head. A topic is three indices, into the lists "kind", "where" and "what"
                 of `names`
    value.npy    text.npy    cause.npy   field.npy

The type of each array except the head is the smallest of int8, int16, int32 and int64 that holds its numbers. `text`
and `field` are indices into their lists in `names`, so each string is stored once. `ticks_per_second` is a whole
number, a fraction as text ("100000000/3"), or null.

A capture is stored as one "edge" record for each edge, in which `where` is the number of the channel; `capture` in the
head contains all other data of the capture. If a run is read as a capture, each wire that changed at least once is a
channel. `clocks` is a dictionary from each unit to pairs of a tick and the SYSCLKOUT from this tick on, in Hz as text.
"""

from __future__ import annotations

import io
import json
import zipfile
import zlib
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from tokenize import TokenError
from typing import IO, Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from ...core.input_files import open_regular
from ...core.records import RECORDED, Kind
from ..capture.capture import NO_SALVAGE, BadCapture, Capture, Channel, Span, channel_of_states
from ..capture.sampling import on_grid, refuse_beyond
from .record_table import COLUMNS, TABLES, TOPIC, RecordTable, Topics

NAME = "periph-sim records (.psr)"
SUFFIXES = (".psr",)

FORMAT = "periph-sim records"
VERSION = 3
STORED = ("number", "tick", "topic", "value", "text", "cause", "field")
DIFFERENCES = ("number", "tick")
WIDTHS = ("|i1", "<i2", "<i4", "<i8")
MOST_BYTES = 4 << 30  # maximum size of all columns together: more than 80 million records
ROW = sum(np.dtype(dtype).itemsize for _, dtype in COLUMNS.values())
EDGE = Kind.EDGE.value
COPY = "copy or record it again"
# Exceptions that zipfile raises for a damaged archive.
BROKEN_ZIP = (zipfile.BadZipFile, zlib.error, EOFError, OSError, NotImplementedError, RuntimeError)
# Exceptions that numpy raises for a damaged header of an array, because numpy parses the header as a Python literal.
UNREADABLE = (ValueError, SyntaxError, TokenError, TypeError, KeyError, AttributeError, MemoryError, RecursionError)


def recognises(path: Path, head: bytes) -> bool:
    return head[:4] == b"PK\x03\x04" and head[30:38] == b"head.npy"


def read(path: Path, rate: Fraction | None = None, salvage: bool = False) -> Capture:
    """Read the edges as a Capture, in samples of `rate` if it is given.

    Raise BadCapture if the file has errors, if a run has no edge of a wire, or if `rate` does not fit the edges.

    salvage: True to say in the error for a damaged file that no part of it can be read.
    """
    try:
        head, table = _load(path)
        capture = _stored(path, head, table) if head.get("capture") is not None else _wires(path, table)
    except BadCapture as error:
        if not salvage or error.way_out != COPY:
            raise
        raise BadCapture(path, error.place, error.found, error.expected, COPY + NO_SALVAGE) from error
    return capture if rate is None or rate == capture.rate else _at_rate(capture, rate)


def read_table(path: Path) -> RecordTable:
    """Read all records as columns. Raise BadCapture if the file has errors."""
    return _load(path)[1]


def holds_run(path: Path) -> bool:
    """Return True if the file is a recorded run; False if it is a capture, of another kind, damaged or missing."""
    try:
        with open_regular(path) as file:
            known = recognises(path, file.read(38))
        if not known:
            return False
        with zipfile.ZipFile(path) as archive:
            return _head(path, archive).get("capture") is None
    except (BadCapture, *BROKEN_ZIP):
        return False


def write(capture: Capture, path: Path) -> None:
    """Write a capture with all its data except its path."""
    channels = capture.channels
    tick = np.concatenate([np.empty(0, np.int64), *(channel.edges for channel in channels)])
    value = np.concatenate([np.empty(0, np.uint8), *(channel.levels for channel in channels)])
    where = np.repeat(np.arange(len(channels)), [len(channel.edges) for channel in channels])
    order = np.lexsort((where, tick))
    count = len(tick)
    zeros = np.zeros(count, np.int64)
    rows: dict[str, NDArray[Any]] = {
        "number": np.arange(1, count + 1),
        "tick": tick[order],
        "where": where[order],
        "value": value[order],
    }
    columns = {name: rows.get(name, zeros).astype(dtype) for name, (_, dtype) in COLUMNS.items()}
    names = {"kind": (EDGE,), "where": tuple(c.name for c in channels), "what": ("level",)}
    names |= {"text": ("",), "field": ("",)}
    about = {
        "length": capture.length,
        "sampled": capture.sampled,
        "exact": capture.exact,
        "notes": list(capture.notes),
        "channels": [
            {"index": c.index, "initial": c.initial, "unknown": [list(span) for span in c.unknown]} for c in channels
        ],
    }
    with path.open("wb") as file:
        write_table(RecordTable(columns, names, capture.rate, capture.length), file, about)


def write_table(table: RecordTable, file: IO[bytes], capture: dict[str, Any] | None = None) -> None:
    """Write the members to an open file. Equal tables give equal bytes.

    capture: the data of a capture that are stored in the head; None for a run.
    """
    per_second, topics = table.per_second, table.topics()
    stated: int | str | None = None if per_second is None else str(per_second)
    if per_second is not None and per_second.denominator == 1:
        stated = int(per_second)
    head = {
        "format": FORMAT,
        "version": VERSION,
        "ticks_per_second": stated,
        "end": table.end,
        "names": table.names,
        "topics": topics.indices.tolist(),
        "modules": table.modules,
        "clocks": {unit: [[tick, str(hz)] for tick, hz in of] for unit, of in table.clocks.items()},
        "capture": capture,
    }
    arrays = {"head": np.frombuffer(json.dumps(head).encode(), np.uint8)}
    with zipfile.ZipFile(file, "w") as archive:
        for name in ("head", *STORED):
            values = arrays.get(name)
            if values is None:
                values = _stored_as(name, topics.row if name == "topic" else table.columns[name])
            member = zipfile.ZipInfo(f"{name}.npy")  # a member without a date, so that equal runs give equal files
            member.create_system = 3
            content = io.BytesIO()
            np.lib.format.write_array(content, values, allow_pickle=False)
            # Compression level 6 would take three times as long and save about a third of the size.
            archive.writestr(member, content.getbuffer(), zipfile.ZIP_DEFLATED, 1)


def _stored_as(name: str, values: NDArray[Any]) -> NDArray[Any]:
    if name in DIFFERENCES:
        values = np.diff(values, prepend=values.dtype.type(0))  # modulo 2**64, like the sums when the file is read
    least, most = (int(values.min()), int(values.max())) if len(values) else (0, 0)
    narrow = next(width for width in WIDTHS if np.iinfo(width).min <= least and most <= np.iinfo(width).max)
    return values.astype(narrow)


def _bad(path: Path, place: str, found: str, expected: str, way_out: str = COPY) -> NoReturn:
    raise BadCapture(path, place, found, expected, way_out)


def _load(path: Path) -> tuple[dict[str, Any], RecordTable]:
    try:
        with zipfile.ZipFile(path) as archive:
            total = sum(info.file_size for info in archive.infolist())
            if total > MOST_BYTES:
                _bad(path, "its members", f"{total} bytes unpacked", f"at most {MOST_BYTES}", "record a shorter run")
            head = _head(path, archive)
            columns = {name: _column(path, archive, name, WIDTHS) for name in STORED}
    except BROKEN_ZIP as error:
        raise BadCapture(path, "the archive", f"a broken zip ({_said(error)})", "an undamaged file", COPY) from error
    lengths = {name: len(values) for name, values in columns.items()}
    if len(set(lengths.values())) != 1:
        _bad(path, "its columns", f"lengths {lengths}", "one length")
    return head, _table(path, head, columns, _topics(path, head, columns))


def _said(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def _column(path: Path, archive: zipfile.ZipFile, name: str, dtypes: tuple[str, ...]) -> NDArray[Any]:
    """Read the array of a member. The type and the size of the array are checked before memory is allocated."""
    try:
        size = archive.getinfo(f"{name}.npy").file_size
    except KeyError:
        _bad(path, "the zip", f"no member {name}.npy", "one")
    with archive.open(f"{name}.npy") as file:
        try:
            version = np.lib.format.read_magic(file)
            if version != (1, 0):
                _bad(path, f"{name}.npy", f"layout {version[0]}.{version[1]}", "layout 1.0")
            shape, _, found = np.lib.format.read_array_header_1_0(file)
        except UNREADABLE as error:
            raise BadCapture(path, f"{name}.npy", _said(error), "the head of an array", COPY) from error
        if found not in map(np.dtype, dtypes) or len(shape) != 1 or shape[0] * found.itemsize > size:
            expected = f"one column of {', '.join(np.dtype(one).name for one in dtypes)}"
            _bad(path, f"{name}.npy", f"an array of {found}, shape {shape}, in {size} bytes", expected)
        if shape[0] > MOST_BYTES // ROW:
            _bad(path, f"{name}.npy", f"{shape[0]} records", f"at most {MOST_BYTES // ROW}", "record a shorter run")
        content = file.read()
    if len(content) != shape[0] * found.itemsize:
        _bad(path, f"{name}.npy", f"{len(content)} bytes", f"{shape[0] * found.itemsize} for {shape[0]} records")
    return np.frombuffer(content, found)


def _head(path: Path, archive: zipfile.ZipFile) -> dict[str, Any]:
    try:
        head = json.loads(_column(path, archive, "head", ("|u1",)).tobytes())
    except (ValueError, RecursionError) as error:
        if isinstance(error, BadCapture):
            raise
        raise BadCapture(path, "head.npy", _said(error), "a JSON object", COPY) from error
    if not isinstance(head, dict) or head.get("format") != FORMAT:
        _bad(path, "head.npy", "another kind of file", f"the format {FORMAT!r}", "give a recording of periph-sim")
    version = head.get("version")
    if type(version) is not int or version < VERSION:
        _bad(path, "head.npy", f"version {version!r}", f"version {VERSION}", "record it again")
    if version > VERSION:
        _bad(path, "head.npy", f"version {version}", f"up to {VERSION}", "read it with the newer periph-sim it is from")
    return head


def _topics(path: Path, head: dict[str, Any], columns: dict[str, NDArray[Any]]) -> Topics:
    """Return the topics of the file, and convert the stored columns in place to the columns of COLUMNS."""
    row = columns.pop("topic")
    try:
        given = [[_whole(place) for place in topic] for topic in head["topics"]]
        if any(len(topic) != len(TOPIC) for topic in given):
            raise ValueError("a topic without its three places")
        of = np.array(given, np.int64).reshape(-1, len(TOPIC))
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise BadCapture(path, "head.npy", f"{type(error).__name__} {error}", "topics", COPY) from error
    if len(row) and not 0 <= int(row.min()) <= int(row.max()) < len(of):
        _bad(
            path, "topic.npy", f"places {int(row.min())} to {int(row.max())}", f"places in a table of {len(of)} topics"
        )
    for place, name in enumerate(TOPIC):
        columns[name] = np.minimum(of[:, place], np.iinfo(COLUMNS[name][1]).max).astype(COLUMNS[name][1])[row]
    for name in DIFFERENCES:
        columns[name] = np.cumsum(columns[name], dtype=np.int64)
    full = {name: columns[name].astype(dtype, copy=False) for name, (_, dtype) in COLUMNS.items()}
    columns.update(full)
    return Topics(of, row.astype(np.uint32))


def _table(path: Path, head: dict[str, Any], columns: dict[str, NDArray[Any]], topics: Topics) -> RecordTable:
    """Build the table after checking that the head and the columns agree."""
    try:
        names = {name: tuple(_strings(head["names"][name])) for name in TABLES}
        end = _whole(head["end"])
        per_second = _rate(head["ticks_per_second"])
        modules = {str(unit): tuple(_strings(of)) for unit, of in head["modules"].items()}
        clocks = {str(unit): _clock(of) for unit, of in head.get("clocks", {}).items()}
    except (KeyError, TypeError, ValueError, AttributeError, ZeroDivisionError) as error:
        raise BadCapture(path, "head.npy", f"{type(error).__name__} {error}", "names, end and rate", COPY) from error
    for name, known in names.items():
        if len(columns[name]) and int(columns[name].max()) >= len(known):
            member = "head.npy, topics" if name in TOPIC else f"{name}.npy"
            _bad(path, member, f"place {int(columns[name].max())}", f"places in a table of {len(known)} names")
    known_kinds = [kind.value for kind in RECORDED]
    strange = [name for name in names["kind"] if name not in known_kinds]
    if strange:
        _bad(path, "head.npy", f"records of kind {strange[0]!r}", ", ".join(known_kinds))
    return RecordTable(columns, names, per_second, end, modules, topics, clocks)


def _strings(given: Any) -> list[str]:
    if not isinstance(given, list) or not all(isinstance(item, str) for item in given):
        raise ValueError("no list of names")
    return given


def _clock(given: Any) -> tuple[tuple[int, Fraction], ...]:
    """Parse pairs of a tick and a frequency. Raise ValueError if one is invalid, there are none, or ticks decrease."""
    found = tuple((_whole(tick), Fraction(hz)) for tick, hz in given)
    if not found or any(hz <= 0 for _, hz in found) or any(one[0] > other[0] for one, other in pairwise(found)):
        raise ValueError("a clock that is none")
    return found


def _whole(given: Any) -> int:
    if type(given) is not int or not 0 <= given < 1 << 63:
        raise ValueError(f"no count: {given!r}")
    return given


def _rate(given: Any) -> Fraction | None:
    if given is None:
        return None
    if not isinstance(given, (int, str)) or len(str(given)) > 100 or (rate := Fraction(given)) <= 0:
        raise ValueError(f"no rate: {given!r}")
    return rate


def _wires(path: Path, table: RecordTable) -> Capture:
    """Return the whole run as a capture of all wires that changed at least once, in order of their first changes."""
    rows = table.rows(Kind.EDGE)
    if (np.diff(table.tick[rows], prepend=0) < 0).any():
        _bad(path, "tick.npy", "an edge before the one above", "times that rise from 0")
    length = max(table.end, int(table.tick[rows[-1]]) + 1 if len(rows) else 1, 1)
    where = table.columns["where"][rows]
    places, firsts = np.unique(where, return_index=True)
    channels = []
    for index, place in enumerate(places[np.argsort(firsts)].tolist()):
        own = rows[where == place]
        levels = (table.value[own] != 0).astype(np.uint8)
        # If there is no edge at tick 0, the level at tick 0 is the opposite of the level after the first edge.
        at, states = np.append(0, table.tick[own]), np.append(1 - levels[0], levels)
        channels.append(channel_of_states(table.names["where"][place], index, at, states, length))
    if not channels:
        _bad(path, "its records", "no edge of a wire", "edges", "record a run in which a wire changes")
    return Capture(path, table.per_second, length, tuple(channels), sampled=False, exact=True)


def _stored(path: Path, head: dict[str, Any], table: RecordTable) -> Capture:
    about = head["capture"]
    try:
        length = _whole(about["length"])
        notes = tuple(_strings(about["notes"]))
        given = list(about["channels"])
        sampled, exact = about["sampled"], about.get("exact", False)  # the oldest files have no `exact`
        if type(sampled) is not bool or type(exact) is not bool:
            raise ValueError("sampled or exact")
        if len(given) != len(table.names["where"]) or length < 1:
            raise ValueError("channels or length")
        channels = tuple(_channel(table, place, entry, length) for place, entry in enumerate(given))
    except (KeyError, TypeError, ValueError) as error:
        raise BadCapture(path, "head.npy", f"a capture without {error}", "all of it", COPY) from error
    return Capture(path, table.per_second, length, channels, sampled, notes, exact)


def _channel(table: RecordTable, place: int, entry: dict[str, Any], length: int) -> Channel:
    own = table.columns["where"] == place
    edges, levels = table.tick[own], table.value[own].astype(np.uint8)
    initial, index = _whole(entry["initial"]), _whole(entry["index"])
    unknown = tuple(Span(_whole(begin), _whole(end)) for begin, end in entry["unknown"])
    channel = Channel(table.names["where"][place], index, initial, edges, unknown)
    rising = (np.diff(edges, prepend=0) > 0).all() and (not len(edges) or edges[-1] < length)
    spans = [0, *(position for span in unknown for position in span), length]
    if initial > 1 or not rising or spans != sorted(spans) or (channel.levels != levels).any():
        raise ValueError(f"sound edges of channel {place}")
    return channel


def _at_rate(capture: Capture, rate: Fraction) -> Capture:
    """Convert a capture to a rate. For samples, or without a rate, only `rate` changes; otherwise ticks become samples.

    Raise BadCapture if an edge is between two samples, if two edges of a channel are in one sample, or if the capture
    ends after sample MOST_POSITION.
    """
    ratio = capture.rate
    if capture.sampled or ratio is None:
        return replace(capture, rate=rate)
    refuse_beyond(capture.path, capture.length, ratio, rate)
    said = f"an edge at position {{}} of {ratio} a second"
    channels = []
    length = int(-(-capture.length * rate // ratio))
    for c in capture.channels:
        lines = [c.edges, np.array(c.unknown, np.int64).reshape(-1)]
        (edges, bounds), _ = on_grid(capture.path, lines, 0, ratio, rate, said)
        if (np.diff(edges, prepend=0) <= 0).any():
            raise BadCapture(
                capture.path,
                "its times",
                f"two edges of {c.name} in one sample of {rate} Hz",
                "one",
                "state the right rate or none",
            )
        length = max([length, *(edges[-1:] + 1).tolist()])
        unknown = tuple(Span(*span) for span in bounds.reshape(-1, 2).tolist())
        channels.append(Channel(c.name, c.index, c.initial, edges, unknown))
    return Capture(capture.path, rate, length, tuple(channels), True, capture.notes)
