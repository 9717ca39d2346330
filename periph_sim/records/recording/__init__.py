"""Recording of a run to a file. The file appears only when the run is over and the recording is complete.

A run that is not recorded imports neither a writer nor a table of records.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, ClassVar, Literal

from ...core.discover import modules_with
from ...core.phrases import did_you_mean
from ...core.records import RECORDED, Kind, Record, Recorder, RecordSink
from ...core.time import Timebase

if TYPE_CHECKING:
    from ...traces.formats.record_table import Clocks, RecordTable


class RecordingWriter:
    """Base class of the writers of recordings, one for each format. Modules list their writers in `FORMATS`.

    SUFFIX: the end of the names of the files, such as ".psr".
    MODE: "w" for text, "wb" for bytes.
    KINDS: the kinds of records that the format needs.
    write: the method that is called with each record.
    sink: a RecordSink, which receives the fields of each record of a run without a Record object. It replaces `write`,
        except in `rewrite`; None if `write` receives the records.
    """

    SUFFIX: ClassVar[str]
    MODE: ClassVar[Literal["w", "wb"]] = "w"
    KINDS: ClassVar[Iterable[Kind]] = RECORDED

    write: Callable[[Record], None]
    sink: RecordSink | None = None

    def __init__(self, file: IO[Any], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> None:
        """modules: for each unit, the names of its modules, as in `I2C-A`, and of its named pins, as in `pin:MODEL`."""
        self._file = file
        self._per_second = timebase.per_second

    def close(self, now: int, clocks: Clocks) -> None:
        """Write what has not been written yet.

        now: the last tick of the run.
        clocks: the history of SYSCLKOUT of each unit.
        """


class BadRecording(ValueError):
    """Error: the recording cannot be written. The message is one sentence."""


Subscribe = Callable[[Recorder, Timebase], None]
EndedAt = Callable[[int, "Clocks"], None]


@cache
def recording_formats() -> dict[str, type[RecordingWriter]]:
    """Return a dictionary from suffixes to the writers that the modules of this package define."""
    found = modules_with("FORMATS", __name__, __path__).values()
    return {one.SUFFIX: one for module in found for one in module.FORMATS}


def format_of(path: Path) -> type[RecordingWriter] | None:
    """Return the writer of the format whose suffix, such as ".perfetto.json", the file has; None if there is none."""
    name = path.name.casefold()
    return next((found for suffix, found in recording_formats().items() if name.endswith(suffix)), None)


@contextmanager
def recording(path: Path | None, modules: dict[str, tuple[str, ...]]) -> Iterator[tuple[Subscribe, EndedAt]]:
    """Yield two functions for the recording of one run.

    The first function takes the recorder and the timebase of a scene; from then on, the records of this scene are
    written. The second function must be called at the end of the run, with the last tick and the clocks of the units.

    path: the file of the recording; if it is None, the functions do nothing.
    modules: for each unit, the names of its modules and of its named pins, as in `RecordingWriter`.

    Raise BadRecording if the suffix is unknown or the file cannot be written. A BadCapture in the block is converted to
    BadRecording. The first function raises BadRecording if a library of the format is missing.
    """
    writers: list[RecordingWriter] = []

    def ended_at(tick: int, clocks: Clocks) -> None:
        for writer in writers:
            writer.close(tick, clocks)

    if path is None:
        yield lambda recorder, timebase: None, ended_at
        return
    with _opened(path) as (chosen, file):

        def subscribe(recorder: Recorder, timebase: Timebase) -> None:
            writer = chosen(file, timebase, modules)
            writers.append(writer)
            recorder.subscribe(chosen.KINDS, writer.sink or writer.write)

        yield subscribe, ended_at


def rewrite(table: RecordTable, path: Path) -> None:
    """Write a recorded run in the format that the suffix of `path` selects, as `run --record` would have written it.

    Raise BadRecording if the suffix is unknown, if the file cannot be written, or if a nanosecond is not a whole number
    of ticks. In every recorded run, a nanosecond is a whole number of ticks.
    """
    per_second = table.per_second
    with _opened(path) as (chosen, file):
        if per_second is None or per_second.denominator != 1 or per_second % 10**9:
            raise BadRecording(
                f"{path}: cannot be written ({per_second} ticks a second; a run has whole ones a nanosecond)"
            )
        writer = chosen(file, Timebase(int(per_second)), table.modules)
        wanted = frozenset(chosen.KINDS)
        write = writer.write
        for record in table.records():
            if record.kind in wanted:
                write(record)
        writer.close(table.end, table.clocks)


@contextmanager
def _opened(path: Path) -> Iterator[tuple[type[RecordingWriter], IO[Any]]]:
    """Yield the writer's class for `path`, and the open file, which appears at `path` only if no error occurs."""
    from ...traces.capture.capture import BadCapture
    from ...traces.formats import atomic_write

    chosen = format_of(path)
    if chosen is None:
        hint = did_you_mean(path.suffix, sorted(recording_formats()))
        raise BadRecording(f"{path}: no recording is written as {path.suffix!r}; {hint}")
    encoding = "utf-8" if chosen.MODE == "w" else None
    try:
        with atomic_write(path) as unfinished, unfinished.open(chosen.MODE, encoding=encoding) as file:
            yield chosen, file
    except BadCapture as error:
        raise BadRecording(str(error)) from None
