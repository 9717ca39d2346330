"""The host: sends frames over a UART, normally one every period.

schedule --> values of frame n --> bytes --> UartSender
"""

# core: compiled

from __future__ import annotations

from array import array
from bisect import bisect_right
from collections.abc import Callable, Sequence
from fractions import Fraction
from random import Random
from typing import Literal

import msgspec

from ..bus.uart.sender import UartSender
from ..core.agent import Agent
from ..core.chip import NEVER
from ..core.kernel import Kernel
from ..core.state import State

# Tags of events: a new frame begins, or a frame is sent again.
FRAME, FRAME_AGAIN = range(2)


PacedBy = Literal["schedule", "pause"]


class HostSchedule(msgspec.Struct, frozen=True):
    """The times at which the host sends frames. Times are in ticks.

    first: the time from the start of the run to the first frame.
    period: the exact period of the frames.
    jitter: the maximum random delay of a frame. Delays are uniformly distributed from 0 to this maximum.
    gap: the pause between bytes, in bits.
    lose: the bytes that are not sent, as pairs (number of the frame, index of the byte in the frame).
    frames: number of frames; None for no end.
    paced_by: "schedule": frame n is due n periods after frame 0. "pause": a frame is due one period after the previous
        frame began, as in a program that sleeps after each frame; so delays accumulate.
    silent: spans (begin, end) of ticks. A frame that would begin in a span, from `begin` to just before `end`, is
        left out.
    twice: numbers of the frames that are sent again immediately after their end.
    starts: the ticks at which the frames begin; None if `first`, `period` and `jitter` determine these ticks.
    """

    first: int
    period: Fraction | int
    jitter: int = 0
    gap: Fraction = Fraction(0)
    lose: frozenset[tuple[int, int]] = frozenset()
    frames: int | None = None
    paced_by: PacedBy = "schedule"
    silent: tuple[tuple[int, int], ...] = ()
    twice: frozenset[int] = frozenset()
    starts: Sequence[int] | None = None


class Host(Agent):
    """An agent that sends the frames of a schedule.

    frames: the number of frames that the host has begun to send.
    bytes: the number of bytes in these frames, without the bytes that are not sent (`HostSchedule.lose`).
    late: the number of frames that were left out because the previous frame was still being sent, or sent again.
    sent: functions called with (number, values, tick at which the last stop bit ends) at the last edge of each frame,
        also of a repeated frame.
    """

    STATE = State(
        "_peer _number _sending _again _once_more _random",
        ticks="_due_next _due",
        results="_due _sending",
        expires="_due_next",
    )

    _sending: tuple[int, tuple[int, ...], bytes]  # number, values and bytes of the frame in progress
    _again: bool  # True if the frame in progress, or the last one, must still be sent a second time

    def __init__(
        self,
        kernel: Kernel,
        peer: UartSender,
        schedule: HostSchedule,
        values: Callable[[int], tuple[int, ...]],
        encode: Callable[[tuple[int, ...]], bytes],
        seed: int = 0,
    ) -> None:
        """Build the host, and schedule its first frame.

        values: a function from the number of a frame to its values.
        encode: a function from values to bytes.
        """
        self.who = peer.who
        self.frames = 0
        self.bytes = 0
        self.late = 0
        self.sent: list[Callable[[int, tuple[int, ...], int], None]] = []
        self._kernel = kernel
        self._peer = peer
        self._schedule = schedule
        self._values = values
        self._encode = encode
        self._random: Random = Random(seed)
        self._first: int = kernel.now + schedule.first
        self._period: Fraction = Fraction(schedule.period)
        self._pause = int(self._period // 1)
        self._by_schedule: bool = schedule.paced_by == "schedule" and schedule.starts is None
        self._number = 0
        self._again = False
        # `_due` has the ticks at which the frames so far were due. If `due` calculates these ticks from the period,
        # `_due` has only the first of them.
        if schedule.starts:
            self._first = schedule.starts[0]
        self._due: array[int] = array("q", [self._first])
        # The due tick of the next frame. After the last frame: its due tick, or NEVER with a list of starts.
        self._due_next: int = self._first
        self._plan(self._first)

    @property
    def is_sending(self) -> bool:
        return self._peer.busy

    @property
    def last_data(self) -> bytes:
        """The bytes of the last frame that has begun. At least one frame must have begun."""
        return self._sending[2]

    def start_frame(self, tick: int) -> None:
        """Schedule one more frame after all frames of the schedule, which must have a list of starts."""
        if not self._number:
            self._first = self._due[0] = tick
        self._due_next = tick
        self._kernel.schedule(tick, self, FRAME)

    def act(self, tag: int) -> None:
        if tag == FRAME:
            self._begin(self._due_next)
        else:
            number, values, data = self._once_more
            self._send(number, values, data, False)

    def due(self, number: int) -> int:
        """Return the tick at which a frame is due, without jitter.

        With paced_by = "pause" or a list of starts, this tick is known only for frame 0 and frames that have begun.
        """
        if self._by_schedule:
            return self._first + number * self._period.numerator // self._period.denominator
        return self._due[number]

    def frame_at(self, tick: int) -> Fraction:
        """Return the position of a past tick among the frames: 2 when frame 2 is due, 2.5 half a period later.

        If frame 3 is due more than a period after frame 2, the result is 3 from the end of this period until frame 3
        is due. Before frame 0 is due, the result is negative.
        """
        period = self._period
        if self._by_schedule or tick < self._first:
            return Fraction(tick - self._first) / period
        number = bisect_right(self._due, tick) - 1
        return number + min(Fraction(tick - self._due[number]) / period, Fraction(1))

    def _plan(self, due: int) -> None:
        schedule = self._schedule
        if schedule.starts is not None:
            self._due_next = NEVER  # after the last start in the list, until `start_frame` adds a frame
            if self._number < len(schedule.starts):
                self._due_next = schedule.starts[self._number]
                self._kernel.schedule(self._due_next, self, FRAME)
        elif schedule.frames is None or self._number < schedule.frames:
            late = self._random.randrange(schedule.jitter + 1) if schedule.jitter else 0
            self._due_next = due
            self._kernel.schedule(due + late, self, FRAME)

    def _begin(self, due: int) -> None:
        schedule, now = self._schedule, self._kernel.now
        number, self._number = self._number, self._number + 1
        if number and not self._by_schedule:
            self._due.append(due)
        self._plan(self.due(self._number) if self._by_schedule else now + self._pause)
        for begin, end in schedule.silent:
            if begin <= now < end:
                return
        if self._peer.busy or self._again:
            self.late += 1
            return
        values = self._values(number)
        self._send(number, values, self._encode(values), number in schedule.twice)

    def _send(self, number: int, values: tuple[int, ...], data: bytes, again: bool) -> None:
        self._sending, self._again = (number, values, data), again
        lose = self._schedule.lose
        if lose:
            data = bytes(byte for place, byte in enumerate(data) if (number, place) not in lose)
        self.frames += 1
        self.bytes += len(data)
        self._peer.send(data, self._schedule.gap, self._over)

    def _over(self, tick: int) -> None:
        """Handle the last edge of a frame. tick: the end of its last stop bit."""
        if self._again:
            self._once_more: tuple[int, tuple[int, ...], bytes] = self._sending  # the frame to send again
            self._kernel.schedule(tick, self, FRAME_AGAIN)
        number, values, _ = self._sending
        for callback in self.sent:
            callback(number, values, tick)
