"""A digest of the times of all events that chains are made of.

    BUS, ACCESS, IRQ, SPAN of a run --> "TICKS EVENT" lines, as in chains --> BLAKE2b

Two runs with one digest have equal chains, so no second run is needed if nothing changed.
"""

from __future__ import annotations

from hashlib import blake2b

from ....core.records import Kind, Record, Recorder
from .event_chain import KINDS, description

BYTES = 16


class EventDigest:
    """Computes the digest of a run's events. start: the first tick of the run, from which times are counted."""

    def __init__(self, recorder: Recorder, start: int) -> None:
        self._start = start
        self._hash = blake2b(digest_size=BYTES)
        recorder.subscribe(KINDS, self._add)

    def _add(self, record: Record) -> None:
        if record.kind is not Kind.ACCESS or record.what.startswith("W "):
            self._hash.update(f"{record.tick - self._start} {description(record)}\n".encode())

    @property
    def text(self) -> str:
        """The digest of all events so far, in hexadecimal."""
        return self._hash.hexdigest()
