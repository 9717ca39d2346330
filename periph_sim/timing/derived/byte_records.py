"""Records of bytes that were read: the numbers of bytes requested, compared and wrong.

thing            tick               value
bytes asked      START of the read  number of bytes requested
bytes compared   START of the read  number of bytes whose right values are known
wrong bytes      START of the read  number of these bytes that are wrong
zeros            end of the run     number of bytes read as 0 from chips that never returned a host frame's values
unknown bytes    end of the run     number of bytes that may be values of frames that were not compared with them
"""

# core: compiled

from __future__ import annotations

from typing import TYPE_CHECKING

from ...bus.i2c.transfer import Phase, Transfer
from ...core.records import Kind, Recorder
from .transfer_records import I2C, begin_of

if TYPE_CHECKING:
    from ...core.records import Topic
    from . import origins as read_origins  # a class that is named through its module is not imported by compiled code


class ByteRecords:
    """Compares the bytes of reads with `Phase.expect`, or with the values of host frames.

    origins: the object that finds the frame whose values a read returned; None if no bytes are compared with frames.
    wrong_places: the number of wrong bytes at each place, such as "gyroscope byte 0".
    first_wrong: a sentence about the first wrong read.
    """

    def __init__(self, recorder: Recorder, origins: read_origins.Origins | None) -> None:
        self.wrong_places: dict[str, int] = {}
        self.first_wrong = ""
        self._origins: read_origins.Origins | None = origins
        self._asked: Topic = recorder.topic(Kind.DATA, I2C, "bytes asked")
        self._compared: Topic = recorder.topic(Kind.DATA, I2C, "bytes compared")
        self._wrong: Topic = recorder.topic(Kind.DATA, I2C, "wrong bytes")
        self._never_shown: Topic = recorder.topic(Kind.DATA, I2C, "zeros")
        self._not_known: Topic = recorder.topic(Kind.DATA, I2C, "unknown bytes")
        # `_zeros` maps a chip's address to the number of bytes that were read as 0 before any values of a frame.
        # These zeros are right if a later read of the same chip returns the values of a frame.
        self._zeros: dict[int, int] = {}
        self._unknown = 0

    def transfer(self, transfer: Transfer) -> None:
        """Compare the bytes that the reads of a complete transfer returned."""
        phase: Phase
        for phase in transfer.phases:
            if phase.read:
                self._read(transfer, phase)

    def finish(self, now: int) -> None:
        """Record, at the end of the run, how many bytes could not be judged."""
        zeros: int = sum(self._zeros.values())
        if zeros:
            self._never_shown.emit(now, zeros)
        if self._unknown:
            self._not_known.emit(now, self._unknown)

    def _read(self, transfer: Transfer, phase: Phase) -> None:
        got = phase.got
        begin = begin_of(transfer, phase)
        if phase.expect is not None or (self._origins is not None and phase.address in self._origins.addresses):
            self._asked.emit(begin, max(phase.count, len(got)))
        if not got:
            return
        wanted = self._wanted(phase)
        compared: int = min(len(got), len(wanted))
        if phase.expect is None and self._origins is not None and not self._is_judged(phase, compared):
            return
        self._compared.emit(begin, compared)
        if got[:compared] != wanted[:compared]:
            self._record_wrong(transfer, phase, wanted)

    def _is_judged(self, phase: Phase, compared: int) -> bool:
        """Return True if the bytes of a read can be judged; otherwise count them for `finish` and return False."""
        origin = None if self._origins is None else self._origins.of(phase)
        if origin is None:
            return True
        if origin.known:
            shown_before: int = self._zeros.pop(phase.address, 0)
            self._compared.emit(phase.start_at, shown_before)
        elif not origin.judged and origin.frame is None:
            self._unknown += compared
        elif not origin.judged:
            self._zeros[phase.address] = self._zeros.get(phase.address, 0) + compared
        return origin.judged

    def _record_wrong(self, transfer: Transfer, phase: Phase, wanted: bytes) -> None:
        wrong = [i for i, (a, b) in enumerate(zip(phase.got, wanted, strict=False)) if a != b]
        if not self.first_wrong:
            self.first_wrong = f"{transfer.name} read {phase.got.hex(' ')} where {wanted.hex(' ')} was expected"
        self._wrong.emit(phase.start_at, len(wrong))
        for i in wrong:
            place = f"{transfer.name} byte {i}"
            self.wrong_places[place] = self.wrong_places.get(place, 0) + 1

    def _wanted(self, phase: Phase) -> bytes:
        if phase.expect is not None:
            return phase.expect
        origin = None if self._origins is None else self._origins.of(phase)
        return b"" if origin is None else origin.wanted
