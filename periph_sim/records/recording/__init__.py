"""Recording of a run to a file, which appears complete when the run is over, or not at all.

One file of this folder is one format. It defines

    SUFFIX                                    the end of its file names
    MODE                                      "w" for text, "wb" for bytes
    KINDS                                     the kinds of records it wants
    open_writer(file, timebase, modules)      a writer that gets each record, and the last tick at the end
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import IO, Any, Literal, Protocol, cast, runtime_checkable

from ...core.discover import modules_with
from ...core.records import Kind, Record, Recorder, RecordSink
from ...core.suggest import did_you_mean
from ...core.time import Timebase
from ...traces.capture.capture import BadCapture
from ...traces.formats.atomic_write import atomic_write
from ...traces.formats.record_table import Clocks, RecordTable


class Writer(Protocol):
    @property
    def write(self) -> Callable[[Record], None]: ...

    def close(self, now: int) -> None: ...


@runtime_checkable
class KeepingWriter(Writer, Protocol):
    """A writer that needs no Record objects."""

    @property
    def sink(self) -> RecordSink: ...


@runtime_checkable
class WriterOfClocks(Writer, Protocol):
    """A writer that stores each unit's SYSCLKOUT, too."""

    clocks: Clocks


class RecordingFormat(Protocol):
    SUFFIX: str
    MODE: Literal["w", "wb"]
    KINDS: Iterable[Kind]

    def open_writer(self, file: IO[Any], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> Writer: ...


class BadRecording(ValueError):
    """A file that cannot be written; one sentence."""


NOT_TOLD: Clocks = {}
Subscribe = Callable[[Recorder, Timebase], None]


class EndedAt(Protocol):
    def __call__(self, tick: int, clocks: Clocks = ...) -> None: ...


@cache
def recording_formats() -> dict[str, RecordingFormat]:
    """Return the formats of this folder by suffix."""
    found = [cast(RecordingFormat, module) for module in modules_with("SUFFIX", __name__, __path__).values()]
    return {one.SUFFIX: one for one in found}


def format_of(path: Path) -> RecordingFormat | None:
    """Return the format whose suffix the name ends with, or None. A suffix may have two dots."""
    name = path.name.casefold()
    return next((found for suffix, found in recording_formats().items() if name.endswith(suffix)), None)


@contextmanager
def recording(path: Path, modules: dict[str, tuple[str, ...]]) -> Iterator[tuple[Subscribe, EndedAt]]:
    """Yield two functions: one for a scene to subscribe with, and one to call with the last tick and the units' clocks.

    modules: by unit, the names of its modules and named pins. Raise BadRecording if the suffix is unknown or the file
    cannot be written.
    """
    chosen = _chosen(path)
    writers: list[Writer] = []
    with _opened(path, chosen) as file:

        def subscribe(recorder: Recorder, timebase: Timebase) -> None:
            writer = chosen.open_writer(file, timebase, modules)
            writers.append(writer)
            recorder.subscribe(chosen.KINDS, writer.sink if isinstance(writer, KeepingWriter) else writer.write)

        def ended_at(tick: int, clocks: Clocks = NOT_TOLD) -> None:
            for writer in writers:
                _close(writer, tick, clocks)

        yield subscribe, ended_at


def rewrite(table: RecordTable, path: Path) -> None:
    """Write a recorded run in another format: the file is the same as if it had been recorded in it.

    BadRecording when the suffix is unknown, the place cannot be written to, or the ticks are not a run's.
    """
    chosen = _chosen(path)
    per_second = table.per_second
    if per_second is None or per_second.denominator != 1 or per_second % 10**9:
        raise BadRecording(
            f"{path}: cannot be written ({per_second} ticks a second; a run has whole ones a nanosecond)"
        )
    wanted = frozenset(chosen.KINDS)
    with _opened(path, chosen) as file:
        writer = chosen.open_writer(file, Timebase(int(per_second)), table.modules)
        write = writer.write
        for record in table.records():
            if record.kind in wanted:
                write(record)
        _close(writer, table.end, table.clocks)


def _close(writer: Writer, tick: int, clocks: Clocks) -> None:
    if isinstance(writer, WriterOfClocks):
        writer.clocks = clocks
    writer.close(tick)


def _chosen(path: Path) -> RecordingFormat:
    chosen = format_of(path)
    if chosen is None:
        hint = did_you_mean(path.suffix, recording_formats())
        raise BadRecording(f"{path}: no recording is written as {path.suffix!r}; {hint}")
    return chosen


@contextmanager
def _opened(path: Path, chosen: RecordingFormat) -> Iterator[IO[Any]]:
    """Yield the open file, which appears at `path` only if no error occurs."""
    try:
        with atomic_write(path) as unfinished, unfinished.open(chosen.MODE, encoding=_encoding(chosen)) as file:
            yield file
    except BadCapture as error:
        raise BadRecording(str(error)) from None


def _encoding(chosen: RecordingFormat) -> str | None:
    return "utf-8" if chosen.MODE == "w" else None
