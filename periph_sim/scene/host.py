"""The host of a case: the sender on RX, the values of its frames, and the true values of the sensor chips.

    [host.motion], ramp --> values of frame n --> Host --> RX
                       '--> Truth at a tick, by the host's own clock

Frames are scheduled by the clock of the host's computer, `ppm` off; the bit rate is that of its serial converter,
which has a crystal of its own: `error`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial
from typing import TypeVar

from msgspec import Struct

from ..bus.uart.frame_format import UartFormat
from ..bus.uart.sender import UartSender
from ..devices.host_pc import Host, HostSchedule, ramp
from ..devices.truth import Axes, LineBetweenFrames, MotionTruth, Truth
from ..imu.host_frame import MotionFrames
from ..imu.models.parameters import ImuParameters
from .case.model import HostTable
from .context import CaseTicks, SceneContext
from .firmware_loader import BadSetting
from .host_motion import encoding_of, frames_of

T = TypeVar("T")


class HostPlan(Struct, frozen=True):
    """Schedule and line of a [host]. bit: ticks of a bit on its line."""

    schedule: HostSchedule
    bit: Fraction


def host_plan(scale: CaseTicks) -> HostPlan:
    """Return the plan of a case's [host]. BadCase, with its line, for a time that is too long."""
    table = scale.case.host
    assert table is not None

    def ticks(length: Fraction) -> int:
        return scale.ticks(length, table.ppm)

    spans = [(scale.start + scale.ticks(begin), scale.ticks(length)) for begin, length in table.silent]
    schedule = HostSchedule(
        first=ticks(table.first),
        period=scale.exact_ticks(table.period, table.ppm),
        jitter=ticks(table.jitter),
        gap=table.gap,
        lose=frozenset(table.lose),
        frames=table.frames,
        paced_by=table.paced_by,
        silent=tuple((begin, begin + length) for begin, length in spans),
        twice=frozenset(table.twice),
    )
    return HostPlan(schedule, scale.timebase.per_second / (Fraction(table.baud) * (1 + table.error / 100)))


class HostAgent:
    """host: the agent. peer: its end of the line. frames: what it sends of a motion, None of a ramp. truth: what chips
    should show, where known.

    sensors: those that firmware computes, None where chips show the values of frames.
    """

    def __init__(self, context: SceneContext, table: HostTable, plan: HostPlan, sensors: ImuParameters | None) -> None:
        """Build the sender and its frames. Raise BadCase, with its line, for an impossible motion or encoding."""
        self._context = context
        self._period = table.period
        encoding = self._settings("encoding", lambda: encoding_of(table.encoding))
        self.frames: MotionFrames | None = None
        if table.motion:
            frames = partial(frames_of, table.motion, encoding, table.first, table.period)
            self.frames = self._settings("motion", frames)
        self.truth = self._truth(table, sensors)
        self._line = plan.bit, UartFormat()
        self.peer = UartSender(context.kernel, context.recorder, context.wire("RX"), plan.bit)
        seed = context.case.seed + 1
        self.host = Host(context.kernel, self.peer, plan.schedule, self.values, seed, encoding.byte_order)

    def _truth(self, table: HostTable, sensors: ImuParameters | None) -> Truth | None:
        """Return the true values of the chips; None if models compute them from frames without a known motion."""
        if sensors is None:
            return LineBetweenFrames(self.values, table.period)
        return None if self.frames is None else MotionTruth(sensors, self.frames.motion, table.first)

    def line(self) -> tuple[Fraction, UartFormat]:
        """Ticks of a bit on its line, and how its characters are made."""
        return self._line

    def values(self, number: int) -> tuple[int, ...]:
        """Six numbers of a frame."""
        return (self.frames or ramp)(number)

    def truth_at(self, tick: int) -> Mapping[str, Axes]:
        """By chip, its true values x, y, z in LSB."""
        assert self.truth is not None
        return self.truth.at(self.host.frame_at(tick) * self._period)

    def _settings(self, table: str, build: Callable[[], T]) -> T:
        try:
            return build()
        except BadSetting as error:
            raise self._context.case.mistake(str(error), "host", table, *filter(None, [error.name])) from None
