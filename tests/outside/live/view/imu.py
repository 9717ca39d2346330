"""A live session of the IMU emulator, advanced by a test, with a head that reads every 20 ms and a host outside."""

from __future__ import annotations

import struct
from fractions import Fraction
from typing import Any

from periph_sim.outside import Session
from periph_sim.outside.live.pacing import Pacer
from periph_sim.outside.live.view.last_round import LastRound
from periph_sim.outside.live.view.status import Board, Status
from tests.outside.sessions import FIRMWARE, Records, case

MODULES = ["I2C-A", "SCI-A", "GPIO", "TIMER0", "TIMER1"]
FRAME = struct.pack("<6h", 3000, -2000, 10000, 0, 0, 0)  # 0.3, -0.2 and 1 rad


class Clock:
    """A clock of which two seconds are one second of the session."""

    def __init__(self) -> None:
        self.session: Session | None = None

    def __call__(self) -> float:
        return 0.0 if self.session is None else 2 * self.session.now / self.session.ticks_per_second


class Imu:
    """The session, with a view if `watched`."""

    def __init__(self, watched: bool = True, **more: Any) -> None:
        unit = {"firmware": str(FIRMWARE / "imu_hil.py"), "modules": MODULES, "settings": {"arithmetic": "float64"}}
        self.records = Records()
        self.wave = LastRound(("SCL", "SDA", "RX", "TX")) if watched else None
        controller = {"order": ["gyroscope", "accelerometer", "magnetometer"], "first": "2 ms", "period": "20 ms"}
        made = case(unit={"dsp": unit}, controller=controller, **more)
        clock = Clock()

        def subscribe(recorder: Any, timebase: Any) -> None:
            self.records.subscribe(recorder, timebase)
            if self.wave is not None:
                self.wave.subscribe(recorder, timebase)

        self.session = Session(made, ("RX",), subscribe=subscribe)
        self.line = self.session.serial("scia")
        self.pacer = Pacer(self.session.ticks_per_second, Fraction(1), "catch-up", clock)
        clock.session = self.session
        self.pacer.wait(0)
        if watched:
            self.status = Status(self.session, self.line, self.pacer, Board(), "/dev/pts/1", self.wave, clock)

    def passes(self, length: str) -> None:
        self.session.advance(self.session.now + self.session.ticks(length))
        self.pacer.reached(self.session.now)
