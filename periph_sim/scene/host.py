"""The host of a case: the sender on RX, the values of its frames, and the true values of the sensor chips.

    [host.motion], if given --> values of frame n --> Host --> RX
                                '--> Truth at a tick, by the host's own clock

The clock of the PC determines when frames begin; its error is `ppm`. The crystal of the PC's serial converter
determines the bit rate; its error is `error`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial
from typing import TypeVar

from ..bus.uart.frame_format import UartFormat
from ..bus.uart.sender import UartSender
from ..devices.host_frames import FrameSource, host_frames
from ..devices.host_pc import Host, HostSchedule
from ..devices.truth import Axes, LineBetweenFrames, Truth
from .case.party_tables import HOST_SEED, HostTable
from .context import CaseTicks, SceneContext
from .firmware_loader import BadSetting
from .unit import FirmwareModel

T = TypeVar("T")


HostPlan = tuple[HostSchedule, Fraction]  # the schedule of a [host], and the length of a bit on RX in ticks


def host_plan(scale: CaseTicks) -> HostPlan:
    """Return the plan of a case's [host]. Raise BadCase for a time with too many ticks."""
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
        starts=scale.starts("frames"),
    )
    return schedule, scale.timebase.per_second / (Fraction(table.baud) * (1 + table.error / 100))


class HostAgent:
    """The host of a scene, with the frames that it sends and the true values of the chips.

    model: the model with which firmware computes the data of emulated chips; None if these chips return the values of
        frames.
    frames: the source of the frames; None if the host has no [host.motion]. Then the frames contain a ramp.
    values: a function from the number of a frame to the values in this frame.
    truth: the values that chips should measure; None if they are not known.
    """

    def __init__(self, context: SceneContext, table: HostTable, plan: HostPlan, model: FirmwareModel | None) -> None:
        """Build the sender and its frames. Raise BadCase for an invalid [host.motion] or [host.encoding]."""
        schedule, bit = plan
        self._context = context
        self._period = table.period
        kind = host_frames()
        encoding = self._settings("encoding", lambda: kind.encoding_of(table.encoding))
        self.frames: FrameSource | None = None
        if table.motion:
            frames = partial(kind.frames_of, table.motion, encoding, table.first, table.period)
            self.frames = self._settings("motion", frames)
        self.values: Callable[[int], tuple[int, ...]] = self.frames or kind.ramp
        self.truth: Truth | None = None
        if model is None:
            self.truth = LineBetweenFrames(self.values, table.period, kind.shown)
        elif self.frames is not None:
            self.truth = model.truth(self.frames.motion, table.first)
        self._line = bit, UartFormat()
        self.peer = UartSender(context.kernel, context.recorder, context.wire("RX"), bit)
        seed = context.case.seed + HOST_SEED
        encode = partial(kind.encode, byte_order=encoding.byte_order)
        self.host = Host(context.kernel, self.peer, schedule, self.values, encode, seed)

    def line(self) -> tuple[Fraction, UartFormat]:
        """Return the length of a bit on the host's line, in ticks, and the format of its characters."""
        return self._line

    def truth_at(self, tick: int) -> Mapping[str, Axes]:
        """Return a dictionary from a chip to its true values x, y, z at a tick, in LSB."""
        assert self.truth is not None
        return self.truth.at(self.host.frame_at(tick) * self._period)

    def _settings(self, table: str, build: Callable[[], T]) -> T:
        try:
            return build()
        except BadSetting as error:
            raise self._context.case.mistake(str(error), "host", table, *filter(None, [error.name])) from None
