"""One number for all that chains are made of: records of a run go in as they come, a digest of their times comes out.

    BUS, ACCESS, IRQ, SPAN of a run --> "TICKS EVENT" lines, as chains have them --> BLAKE2b

Two runs with one digest have equal chains, so the second run that makes them is not needed where nothing changed.
"""

from __future__ import annotations

from hashlib import blake2b

from ...core.records import Kind, Record, Recorder
from .event_chain import KINDS, told

BYTES = 16


class EventDigest:
    """start: the tick at which the run begins; times are counted from it."""

    def __init__(self, recorder: Recorder, start: int) -> None:
        self._start = start
        self._hash = blake2b(digest_size=BYTES)
        recorder.subscribe(KINDS, self._add)

    def _add(self, record: Record) -> None:
        if record.kind is not Kind.ACCESS or record.what.startswith("W "):
            self._hash.update(f"{record.tick - self._start} {told(record)}\n".encode())

    @property
    def text(self) -> str:
        """Of all that happened so far, in hexadecimal digits."""
        return self._hash.hexdigest()
