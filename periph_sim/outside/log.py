"""Log file of the moves that the outside makes. `scene.outside_log` describes the format."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from os.path import relpath
from pathlib import Path
from typing import TextIO

from ..core.input_files import is_input, is_same_file
from ..scene.case.model import Case
from ..scene.outside_log import FORMAT, VERSION
from .errors import OutsideError


class LogWriter:
    """Writer of a log.

    The session calls `begin` when its time begins to pass. Only then is an existing file replaced: a session that fails
    earlier leaves it unchanged. After `begin`, each line is written at once, so that the log is complete even if the
    process is killed.

    Raise OutsideError if the file cannot be written, or if the case was read from it.
    """

    def __init__(self, path: Path, case: Case, ticks_per_second: int, wires: tuple[str, ...]) -> None:
        refuse_input(path, case, "log")
        self._path = path
        self._is_new = not path.exists()
        try:
            handle = os.open(path, os.O_WRONLY | os.O_CREAT, 0o666)
            self._file: TextIO = os.fdopen(handle, "w", encoding="utf-8", newline="\n")
        except OSError as error:
            raise OutsideError(f"{path}: {error.strerror}; give the log another place") from None
        head = {"format": FORMAT, "version": VERSION, "case": case.name, "ticks_per_second": ticks_per_second}
        file: dict[str, object] = {}
        if case.file is not None and case.file.is_file():  # a case that was built by a program has no file
            file = {"file": relpath(case.file, path.parent), "set": case.changes}
        # The values that `begin` writes, one per line of the log; None after `begin`.
        self._waiting: list[object] | None = [{**head, "wires": wires, **file}]

    def begin(self) -> None:
        """Write the lines that were collected so far. Later calls do nothing."""
        if self._waiting is not None:
            if self._path.is_file():  # devices and pipes cannot be truncated
                self._file.truncate(0)
            waiting, self._waiting = self._waiting, None
            for value in waiting:
                self._write(value)

    def serial(self, wire: str) -> None:
        """Write that a `SerialLine` begins to drive this wire."""
        self._write({"serial": wire})

    def instant(self, tick: int, levels: Mapping[str, int], begun: Sequence[str] = ()) -> None:
        """Write the levels to which lines move at a tick. begun: the wires on which a byte begins at this tick."""
        self._write([tick, dict(sorted(levels.items())), *([sorted(begun)] if begun else [])])

    def end(self, tick: int) -> None:
        self.begin()
        self._write({"end": tick})
        self._file.close()

    def close(self) -> None:
        """Close the log of a session that was not finished, without an "end" line.

        If `begin` was not called, a file that the session has created is removed.
        """
        self._file.close()
        if self._waiting is not None and self._is_new:
            self._path.unlink(missing_ok=True)

    def _write(self, value: object) -> None:
        if self._waiting is not None:
            self._waiting.append(value)
            return
        self._file.write(json.dumps(value) + "\n")
        self._file.flush()


def refuse_input(path: Path, case: Case, what: str) -> None:
    """Raise OutsideError if the case or the command reads this file, so that no output replaces it.

    what: the output, for messages.
    """
    if is_input(path) or any(is_same_file(path, file) for file in case.files()):
        raise OutsideError(f"{path}: the session reads this file; give the {what} another place")
