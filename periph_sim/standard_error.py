"""Standard error of a command: what cannot be written is dropped."""

from __future__ import annotations

from contextlib import suppress
from typing import TextIO


class StandardError:
    """Standard error whose failures are ignored: a verdict on standard output does not depend on it.

    stream: None if it was closed when Python started.
    """

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        with suppress(OSError):
            if self._stream is not None:
                self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        with suppress(OSError):
            if self._stream is not None:
                self._stream.flush()

    def isatty(self) -> bool:
        return self._stream is not None and self._stream.isatty()

    def __getattr__(self, name: str) -> object:
        return getattr(self._stream, name)
