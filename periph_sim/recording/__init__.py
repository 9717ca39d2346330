"""Writing a run to a file: records go in as they happen; the file appears whole when the run is over, or not at all.

One file of this folder is one format: it defines SUFFIX, KINDS and `open_writer`.
"""

from __future__ import annotations

import importlib
import os
import pkgutil
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Protocol, cast

from ..core.nearest import near
from ..core.records import Kind, Record, Recorder
from ..core.time import Timebase


class Writer(Protocol):
    def write(self, record: Record) -> None: ...

    def close(self, now: int) -> None: ...


class RecordingFormat(Protocol):
    SUFFIX: str
    KINDS: Iterable[Kind]

    def open_writer(self, file: IO[str], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> Writer: ...


class BadRecording(ValueError):
    """A file that cannot be written; one sentence."""


Subscribe = Callable[[Recorder, Timebase], None]
EndedAt = Callable[[int], None]


def recording_formats() -> dict[str, RecordingFormat]:
    """The formats of this folder by suffix."""
    found: dict[str, RecordingFormat] = {}
    for entry in pkgutil.iter_modules(__path__):
        module = cast(RecordingFormat, importlib.import_module(f"{__name__}.{entry.name}"))
        found[module.SUFFIX] = module
    return found


@contextmanager
def recording(path: Path | None, modules: dict[str, tuple[str, ...]]) -> Iterator[tuple[Subscribe, EndedAt]]:
    """Gives two functions: one that a scene calls to be recorded, one to be told the last tick of the run.

    modules: unit -> its modules. BadRecording when the suffix is unknown or the place
    cannot be written to.
    """
    if path is None:
        yield (lambda recorder, timebase: None), (lambda tick: None)
        return
    formats = recording_formats()
    if path.suffix not in formats:
        raise BadRecording(f"{path}: no recording is written as {path.suffix!r}; {near(path.suffix, formats)}")
    chosen = formats[path.suffix]
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise BadRecording(f"{path}: cannot be written ({error.strerror})") from None
    writers: list[Writer] = []
    try:
        with open(handle, "w", encoding="utf-8") as file:

            def subscribe(recorder: Recorder, timebase: Timebase) -> None:
                writer = chosen.open_writer(file, timebase, modules)
                writers.append(writer)
                recorder.subscribe(chosen.KINDS, writer.write)

            def ended_at(tick: int) -> None:
                for writer in writers:
                    writer.close(tick)

            yield subscribe, ended_at
        os.chmod(name, 0o666 & ~_umask())
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
