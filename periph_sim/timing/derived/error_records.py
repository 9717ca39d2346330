"""Records of errors: the differences between the samples that were read from sensor chips and the true values.

    read of a chip --values x, y, z--.
                                     |-- worst axis --> value error, in millionths of an LSB
    true values of each chip --------'

    thing                  tick                value
    sample                 START of the read   the chip's address; for each read whose transfer ends after the first
                                               host frame. Only reads of 6 bytes make the records below
    value error            START of the read   difference from the true values at the first data bit of the read
    value error at frame   START of the read   difference from the true values at the due time of the host frame that
                                               fits best
    unknown error          START of the read   the chip's address; made instead of `value error at frame` if the frame
                                               that fits best may be one that is no longer stored

The frame that fits best is the frame with the smallest error. It is searched for among the last 8 frames and among all
frames since the frame that fitted the chip's last read best, but at most among the last 64 frames. So `value error at
frame` does not depend on the age of the values.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from math import ceil

from ...bus.i2c.transfer import Phase, Transfer
from ...core.records import Kind, Recorder
from ...core.time import NO_TIME
from ...devices.sensor_rounds import ChipData, known_sensors
from ...devices.truth import Axes, distance
from ..measures.measure import MILLIONTHS
from .transfer_records import begin_of

RECENT = 8  # minimum number of frames that a read is compared with, if the host has sent at least that many
MOST = 64  # maximum number of frames that a read is compared with
BYTES = 6  # number of bytes of a read that returns a whole sample


class _Chip:
    """The state of one chip, and the topics (`core.records`) of its records.

    fitted: the due tick of the frame whose true values were nearest to the chip's last read with a known frame; NO_TIME
        before the first such read.
    """

    def __init__(self, recorder: Recorder, name: str, data: ChipData) -> None:
        self.name = name
        self.data = data
        self.fitted = NO_TIME
        self.sample, self.error, self.at_frame, self.unknown = (
            recorder.topic(Kind.DATA, name, what)
            for what in ("sample", "value error", "value error at frame", "unknown error")
        )


class ErrorRecords:
    """Makes the error records for the values that the controller reads from sensors.

    truth_at: a function from a tick to the true values of each chip.
    frame_due: a function from the number of a host frame to the tick at which the frame is due.
    """

    def __init__(
        self, recorder: Recorder, truth_at: Callable[[int], Mapping[str, Axes]], frame_due: Callable[[int], int]
    ) -> None:
        self._chips = {data.address: _Chip(recorder, name, data) for name, data in known_sensors().items()}
        self._truth_at = truth_at
        self._frame_due = frame_due
        self._due: deque[int] = deque(maxlen=MOST)
        self._left_out = NO_TIME  # the due tick of the frame that was removed last from `_due`

    def frame(self, number: int, values: tuple[int, ...], tick: int) -> None:
        """Store the tick at which host frame `number` was due."""
        if len(self._due) == MOST:
            self._left_out = self._due[0]
        self._due.append(self._frame_due(number))

    def transfer(self, transfer: Transfer) -> None:
        """Record the errors of the samples of a transfer that is over."""
        for phase in transfer.phases:
            chip = self._chips.get(phase.address) if phase.read and self._due else None
            if chip is not None:
                chip.sample.emit(begin_of(transfer, phase), phase.address)
                if len(phase.got) == BYTES:
                    self._record_errors(chip, phase)

    def _record_errors(self, chip: _Chip, phase: Phase) -> None:
        values = chip.data.values(bytes(phase.got))
        if chip.error.has_subscribers:
            chip.error.emit(phase.start_at, _off(values, self._truth_at(phase.answer_at)[chip.name]))
        if chip.at_frame.has_subscribers or chip.unknown.has_subscribers:
            self._record_best(chip, values, phase.start_at)

    def _record_best(self, chip: _Chip, values: Sequence[int], at: int) -> None:
        """Record the difference from the frame whose true values are nearest to the values that were read.

        If a frame that is no longer stored may be nearer, record "unknown error" instead.
        """
        recent = len(self._due) - RECENT
        instants = [due for n, due in enumerate(self._due) if n >= recent or due >= chip.fitted]
        off, fitted = min((_off(values, self._truth_at(due)[chip.name]), -due) for due in instants)
        if self._left_out != NO_TIME and chip.fitted <= self._left_out:
            chip.unknown.emit(at, chip.data.address)
            return
        chip.fitted = -fitted
        chip.at_frame.emit(at, off)


def _off(values: Sequence[int], truth: Axes) -> int:
    """Return the error of the worst axis in millionths of an LSB, rounded up. values: the values that were read."""
    return max(ceil(abs(distance(value, true)) * MILLIONTHS) for value, true in zip(values, truth, strict=True))
