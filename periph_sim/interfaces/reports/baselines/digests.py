"""Digests of a run that a baseline stores, so that runs can be compared without their records.

    BUS, ACCESS, IRQ, SPAN of a run --> "TICKS EVENT" lines, as in chains --> BLAKE2b, one digest
    BUS records of addresses and bytes, with their ACKs --> BLAKE2b, one digest per PART bytes

Runs with the same digest of events have equal chains, so no second run is needed to find the chains. Each digest of
bytes covers all bytes up to its end, so the first digest that differs shows where two runs begin to differ.
"""

from __future__ import annotations

from hashlib import blake2b

from ....core.records import Kind, Record, Recorder
from .event_chain import KINDS, description

BYTES = 16


class EventDigest:
    """Calculation of the digest of a run's events. start: the first tick of the run, from which times are counted."""

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


PART = 64  # number of bus bytes after which a digest is stored
DIGEST = 4  # length of a digest, in bytes


class BusBytes:
    """Calculation of digests of the bytes on the bus. The times of the bytes are not part of the digests."""

    def __init__(self, recorder: Recorder) -> None:
        self._hash = blake2b(digest_size=DIGEST)
        self._count = 0
        self._digests: list[str] = []
        recorder.subscribe([Kind.BUS], self._add)

    def _add(self, record: Record) -> None:
        if record.what not in ("address", "byte"):
            return
        self._hash.update(f"{record.what} {record.value}\n".encode())
        self._count += 1
        if self._count % PART == 0:
            self._digests.append(self._hash.hexdigest())

    @property
    def digests(self) -> list[str]:
        """The digests in hexadecimal: one after every PART bytes, and one after the last byte."""
        return [*self._digests, self._hash.hexdigest()] if self._count % PART else [*self._digests]
