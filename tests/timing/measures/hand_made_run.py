"""A hand-made run: tests add transfers, rounds, frames and characters, and a measure receives their records."""

from __future__ import annotations

from periph_sim.bus.i2c.transfer import Phase, Transfer
from periph_sim.core.records import Kind, Recorder
from periph_sim.core.time import NO_TIME
from periph_sim.devices.host_frames import host_frames
from periph_sim.devices.sensor_rounds import Round
from periph_sim.imu.host_frames import ramp
from periph_sim.timing.derived.origins import FrameOrigins
from periph_sim.timing.derived.read_records import AgeRecords, ByteRecords
from periph_sim.timing.derived.transfer_records import RoundRecords, TransferRecords
from periph_sim.timing.measures.measure import Measure
from periph_sim.timing.rounds import BusRounds
from tests.timing.events_by_hand import make

GYRO, ACCEL, MAGNET, OTHER = 0x68, 0x53, 0x1E, 0x10


class HandMadeRun:
    """A run without a scene.

    measure: a measure, or its fixed name
    checks_host: True if known chips must show values of host frames
    """

    def __init__(
        self,
        measure: Measure | str,
        *,
        checks_host: bool = True,
        period: int = 2000,
        origins: FrameOrigins | None = None,
        polls: bool = False,
    ) -> None:
        self.recorder = Recorder()
        self.measure = make(measure) if isinstance(measure, str) else measure
        self.measure.subscribe(self.recorder)
        self.origins = origins or FrameOrigins(host_frames())
        self.transfers = TransferRecords(self.recorder, polls)
        self.bytes = ByteRecords(self.recorder, self.origins if checks_host else None)
        self.ages = AgeRecords(self.recorder, self.origins)
        self.recorder.subscribe((Kind.SPAN,), self.ages)
        self.bus_rounds = BusRounds(None, lambda: NO_TIME)
        self.rounds = RoundRecords(self.recorder, self.bus_rounds, period)

    def transfer(self, *phases: Phase, name: str = "chip") -> None:
        over = Transfer(name, list(phases))
        for party in (self.origins, self.transfers, self.bytes, self.ages):
            party.transfer(over)

    def is_due(self, due: int) -> None:
        self.bus_rounds.on_due[0](due)

    def misses(self, due: int) -> None:
        self.is_due(due)
        self.bus_rounds.on_missed[0](due)

    def round(self, due: int, end: int, nacked: int = 0, start: int | None = None) -> None:
        self.is_due(due)
        self.rounds.round(Round(1, due, due if start is None else start, end, nacked))

    def character(self, tick: int, received: bool = True) -> None:
        self.recorder.emit(tick, Kind.RECEIVER, "RX", "character", 1)
        if received:
            self.recorder.emit(tick, Kind.RECEIVER, "dsp.SCI-A", "received", 1)

    def words(self, tick: int, words: int, overrun: bool = False) -> None:
        self.recorder.emit(tick, Kind.RECEIVER, "dsp.SCI-A", "words", words)
        if overrun:
            self.recorder.emit(tick, Kind.RECEIVER, "dsp.SCI-A", "lost", 1)

    def span(self, tick: int, value: int, name: str = "model") -> None:
        self.recorder.emit(tick, Kind.SPAN, "dsp", name, value)

    def frame(self, number: int, tick: int) -> None:
        for party in (self.origins, self.ages):
            party.frame(number, ramp(number), tick)

    def finish(self, now: int, unfinished: Transfer | None = None, held_since: int = NO_TIME) -> None:
        self.transfers.finish(now, unfinished, held_since)
        self.bytes.finish(now)
        self.measure.finish(now)

    def summary(self) -> tuple[int, int, int, int]:
        """Return worst, tick of the worst, least, count."""
        m = self.measure
        return m.worst, m.worst_at, m.least, m.count


def read(address: int, got: bytes = b"", at: int = 0, **more: int) -> Phase:
    phase = Phase(address, read=True, count=len(got), acked=True, got=bytearray(got), start_at=at)
    for name, value in more.items():
        setattr(phase, name, value)
    return phase


def wrote(address: int, at: int = 0, acked: bool = True) -> Phase:
    return Phase(address, read=False, start_at=at, acked=acked)


def gyro_bytes(number: int) -> bytes:
    return b"".join(v.to_bytes(2, "big", signed=True) for v in ramp(number)[0:3])


def magnet_bytes(number: int) -> bytes:
    x, y, z = ramp(number)[0:3]
    return b"".join(v.to_bytes(2, "big", signed=True) for v in (x, z, y))


def accel_bytes(number: int) -> bytes:
    return b"".join(v.to_bytes(2, "little", signed=True) for v in ramp(number)[3:6])
