"""The ADXL345's output register and FIFO, with DATA_READY, Overrun and the number of entries.

    sample --> bypass: output register
           --> FIFO, stream, trigger: 32 samples and one more at the output of the filter --> output register

Source: ADXL345 data sheet Rev 0, FIFO section; INT_SOURCE, FIFO_CTL and FIFO_STATUS.
"""

from __future__ import annotations

from collections import deque
from enum import IntEnum

from ...core.state import State

DEPTH = 32
HELD = DEPTH + 1  # including the one at the output of the filter


class Mode(IntEnum):
    BYPASS = 0
    FIFO = 1
    STREAM = 2
    TRIGGER = 3


class Fifo:
    """output: the six bytes of the data registers. triggered: FIFO_TRIG."""

    STATE = State("output mode samples overrun triggered _unread _waiting")

    def __init__(self, overrun_when_filled: bool) -> None:
        self.output = bytes(6)
        self.mode = Mode.BYPASS
        self.samples = 0  # of FIFO_CTL: the watermark, or the number that a trigger keeps
        self.overrun = False
        self.triggered = False
        self._unread = False  # True if the output register is unread, in bypass
        self._waiting: deque[bytes] = deque()
        self._overrun_when_filled = overrun_when_filled

    @property
    def entries(self) -> int:
        return len(self._waiting)

    @property
    def data_ready(self) -> bool:
        return self._unread if self.mode is Mode.BYPASS else bool(self._waiting)

    @property
    def watermark(self) -> bool:
        """True if FIFO_CTL's number of entries is reached; at power-on 0 of 0, hence INT_SOURCE reads 0x02."""
        return self.entries >= self.samples

    @property
    def keeps_first(self) -> bool:
        """True if later samples are lost when it is full; else the oldest are dropped."""
        return self.mode is Mode.FIFO or (self.mode is Mode.TRIGGER and self.triggered)

    def set_up(self, mode: Mode, samples: int) -> None:
        """Apply a write of FIFO_CTL. Bypass empties the FIFO; the other modes keep its contents."""
        if mode is Mode.BYPASS:
            self._waiting.clear()
        if mode is not self.mode:
            self.overrun = self.triggered = self._unread = False
        self.mode, self.samples = mode, samples

    def push(self, sample: bytes) -> None:
        """Add a new sample from the filter."""
        if self.mode is Mode.BYPASS:
            self.overrun |= self._unread
            self.output, self._unread = sample, True
            return
        lost = len(self._waiting) == HELD
        if not (lost and self.keeps_first):
            self._waiting.append(sample)
            if lost:
                self._waiting.popleft()
        self.overrun |= len(self._waiting) >= DEPTH if self._overrun_when_filled else lost

    def trigger(self) -> None:
        """Handle trigger mode's event: the last `samples` are kept, and new ones fill the rest."""
        if self.mode is Mode.TRIGGER and not self.triggered:
            self.triggered = True
            while len(self._waiting) > self.samples:
                self._waiting.popleft()

    def latch(self) -> bytes:
        """Return the sample for a burst of reads; it counts as read, whole or not."""
        if self._waiting:
            self.output = self._waiting.popleft()
        self._unread = self.overrun = False
        return self.output
