"""What the outside does, as a file: each instant goes in as it passes. `scene.outside_log` says what stands in it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from os.path import relpath
from pathlib import Path
from typing import TextIO

from ..scene.case.model import Case
from ..scene.outside_log import FORMAT, VERSION
from .errors import OutsideError


class LogWriter:
    """Each line is written as it is known, so that what was live is there whatever ends the process."""

    def __init__(self, path: Path, case: Case, ticks_per_second: int, wires: tuple[str, ...]) -> None:
        try:
            self._file: TextIO = path.open("w", encoding="utf-8", newline="\n")
        except OSError as error:
            raise OutsideError(f"{path}: {error.strerror}; give the log another place") from None
        head = {"format": FORMAT, "version": VERSION, "case": case.name, "ticks_per_second": ticks_per_second}
        file: dict[str, object] = {}
        if case.file is not None and case.file.is_file():  # and was not made by a program
            file = {"file": relpath(case.file, path.parent), "set": case.changes}
        self._write({**head, "wires": wires, **file})

    def serial(self, wire: str) -> None:
        """From here on a wire is driven by bytes."""
        self._write({"serial": wire})

    def instant(self, tick: int, levels: Mapping[str, int], begun: Sequence[str] = ()) -> None:
        """begun: wires on which a byte begins."""
        self._write([tick, dict(sorted(levels.items())), *([sorted(begun)] if begun else [])])

    def end(self, tick: int) -> None:
        self._write({"end": tick})
        self._file.close()

    def close(self) -> None:
        """Without an end: the session was not finished."""
        self._file.close()

    def _write(self, value: object) -> None:
        self._file.write(json.dumps(value) + "\n")
        self._file.flush()
