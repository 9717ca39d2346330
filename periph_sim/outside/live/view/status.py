"""Snapshots of a live session for display in other threads, from its scene, serial line and pacer.

    transfers --> last readings --> attitude
    counts of the last two seconds --> rates
    registers --> set flags;  budgets --> verdicts so far;  pacer --> lateness

A snapshot consists of plain values. It is created in the session's thread, and other threads may then read it.
A `Board` passes the latest one to the threads that display it.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from typing import TypedDict

from ....bus.i2c.transfer import Transfer
from ....scene.plugins import sensors_of
from ....timing.budget_plan import PER_MILLE
from ....timing.budgets import BudgetJudge
from ....timing.verdict import FAIL, NOT_JUDGED, figure, limit
from ...serial_line import SerialLine
from ...session import Session
from ..loop import Door
from ..pacing import STEPS, TOLERATED, Pacer
from .last_round import LastRound, Wave

WINDOW = 2.0  # seconds over which rates are averaged
SELDOM = 10.0  # seconds between calculations of a percentile, which takes long because it needs all values
PATIENCE = 1.0  # seconds without a new snapshot after which a reader of a board gets None, to check other conditions
EVERY = 0.25  # seconds between two snapshots
SAID = 3  # number of the latest messages that are shown
FLAGS = {
    "SCI": ("SCIRXST.BRKDT", "SCIRXST.FE", "SCIRXST.OE", "SCIRXST.PE", "SCIFFRX.RXFFOVF"),
    "I2C": ("I2CSTR.AL", "I2CSTR.NACK", "I2CSTR.NACKSNT", "I2CSTR.RSFULL", "I2CSTR.SDIR", "I2CSTR.BB"),
}


class SensorReading(TypedDict):
    """The last reading of a sensor. values: x, y, z in `unit`."""

    chip: str
    values: list[float]
    unit: str


class BudgetSoFar(TypedDict):
    """The state of a budget during the run. state: "pass", "fail", or "" as long as the budget is not judged."""

    name: str
    seen: str
    limit: str
    margin: str
    state: str


class Lateness(TypedDict):
    """The lateness of the session's steps, as a histogram.

    steps: the upper bounds of the classes, in seconds.
    counts: the number of steps in each class; the last class has no upper bound.
    late: the number of steps whose lateness exceeds `tolerated`.
    """

    steps: list[float]
    counts: list[int]
    worst: float
    p99: float
    late: int
    slips: int
    tolerated: float
    when_late: str


class StatusSnapshot(TypedDict):
    """The state of a session for display.

    where: the address at which clients reach the session.
    totals: numbers of bytes and rounds so far; "waiting" is the number of bytes that wait to be sent to the SCI.
    rates: the increase of each entry of `totals`, except "waiting", per simulated second. The entry "pace" is the
        number of simulated seconds per second of real time. `rates` is empty in the first snapshot, and if no simulated
        time has passed within WINDOW.
    flags: the status flags that are set, such as "dsp.SCI-A.SCIRXST.FE".
    said: the latest messages about clients.
    over: True if the session has ended.
    """

    case: str
    where: str
    simulated_s: float
    rates: dict[str, float]
    totals: dict[str, int]
    readings: list[SensorReading]
    attitude: list[float] | None
    flags: list[str]
    budgets: list[BudgetSoFar]
    lateness: Lateness | None
    wave: Wave | None
    said: list[str]
    over: bool


class Board:
    """The latest snapshot and its number, counted from 1.

    `put` never waits for readers, so a slow reader misses snapshots.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._number = 0
        self._latest: StatusSnapshot | None = None
        self.closed = False

    def put(self, snapshot: StatusSnapshot) -> None:
        with self._changed:
            self._number += 1
            self._latest = snapshot
            self._changed.notify_all()

    def close(self) -> None:
        """Mark the latest snapshot as the last one, so that readers do not wait for a later one."""
        with self._changed:
            self.closed = True
            self._changed.notify_all()

    def after(self, number: int, timeout: float) -> tuple[int, StatusSnapshot | None]:
        """Wait for a snapshot with a higher number than `number`. Return its number and the snapshot.

        Return (`number`, None) if there is none after `timeout` seconds, or if the board is closed.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._number > number or self.closed, timeout)
            return (self._number, self._latest) if self._number > number else (number, None)

    def snapshots(self) -> Iterator[StatusSnapshot | None]:
        """Yield the latest snapshot, then newer ones, until the board is closed and its last snapshot was yielded.

        If there is none for PATIENCE seconds, yield None, so that the reader can check other conditions. The last value
        may be None, too.
        """
        number, closed = 0, False
        while not closed:
            closed = self.closed
            number, snapshot = self.after(number, PATIENCE)
            yield snapshot


class Status(Door):
    """Publisher that puts a snapshot of a session on a board several times per second. The loop calls it like a door.

    line: the serial line; None if the session is connected to a bus.
    where: the address at which clients reach the session.
    wave: the source of the waveform; None if no waveform is displayed.
    """

    def __init__(
        self,
        session: Session,
        line: SerialLine | None,
        pacer: Pacer,
        board: Board,
        where: str = "",
        wave: LastRound | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.where = where
        self._session, self._line, self._pacer, self._board, self._wave = session, line, pacer, board, wave
        self._clock = clock
        self._due = clock()
        self._said: deque[str] = deque(maxlen=SAID)
        self._readings: dict[str, SensorReading] = {}
        self._rounds = 0
        self._known = sensors_of(session.case)
        self._before: deque[tuple[float, int, dict[str, int]]] = deque()
        self._percentiles: dict[str, tuple[float, BudgetSoFar]] = {}
        scene = session.scene
        self._flags = [
            (f"{unit}.{module}", name)
            for unit, dsp in scene.units.items()
            for module in dsp.sockets
            for name in FLAGS.get(module.partition("-")[0], ())
        ]
        if "SCL" in scene.wires:
            scene.on_transfer(self._transferred)
        if scene.bus.asked is not None:
            scene.on_round(self._round)
        if wave is not None:
            wave.listen(scene)

    def say(self, sentence: str) -> None:
        """Add a message about a client or port, such as that a client has connected."""
        self._said.append(sentence)

    def turn(self) -> None:
        now = self._clock()
        if now >= self._due:
            self._due = now + EVERY
            self._board.put(self.snapshot())

    def close(self) -> None:
        """Put the last snapshot on the board and close the board."""
        self._board.put(self.snapshot(over=True))
        self._board.close()

    def snapshot(self, over: bool = False) -> StatusSnapshot:
        session, scene, line = self._session, self._session.scene, self._line
        totals = {
            "SCI bytes in": 0 if line is None else line.sent,
            "SCI bytes out": 0 if line is None else line.received,
            "waiting": 0 if line is None else line.waiting,
            "I2C bytes": scene.bytes_on_bus(),
            "rounds": self._rounds,
        }
        return {
            "case": session.case.name,
            "where": self.where,
            "simulated_s": session.now / session.ticks_per_second,
            "rates": self._rates(totals),
            "totals": totals,
            "readings": list(self._readings.values()),
            "attitude": self._attitude(),
            "flags": [f"{place}.{name}" for place, name in self._flags if scene.measured.value_of(place, name)],
            "budgets": [self._so_far(one) for one in scene.limits],
            "lateness": self._lateness(),
            "wave": None if self._wave is None else self._wave.wave(scene.start),
            "said": list(self._said),
            "over": over,
        }

    def _transferred(self, transfer: Transfer) -> None:
        for phase in transfer.phases:
            for name, chip in self._known.items():
                if phase.read and phase.address == chip.address and len(phase.got) == 6:
                    per_unit = chip.lsb_per_unit
                    values = [float(value / per_unit) for value in chip.values(bytes(phase.got))]
                    self._readings[name] = {"chip": name, "values": values, "unit": chip.unit}

    def _round(self, _: object) -> None:
        self._rounds += 1

    def _attitude(self) -> list[float] | None:
        """Return the attitude that the model of the firmware calculates from the last readings.

        Return None if there is no model, or if the readings do not suffice.
        """
        model = self._session.scene.model
        readings = {name: reading["values"] for name, reading in self._readings.items()}
        return None if model is None else model.attitude(readings)

    def _rates(self, totals: dict[str, int]) -> dict[str, float]:
        now, tick = self._clock(), self._session.now
        self._before.append((now, tick, totals))
        while now - self._before[0][0] > WINDOW and len(self._before) > 2:
            self._before.popleft()
        first, first_tick, counts = self._before[0]
        simulated = (tick - first_tick) / self._session.ticks_per_second
        if now <= first or not simulated:
            return {}
        names = [name for name in totals if name != "waiting"]
        rates = {name: (totals[name] - counts[name]) / simulated for name in names}
        return rates | {"pace": simulated / (now - first)}

    def _so_far(self, judge: BudgetJudge) -> BudgetSoFar:
        name, now = judge.budget.name, self._clock()
        if name in self._percentiles and now - self._percentiles[name][0] < SELDOM:
            return self._percentiles[name][1]
        verdict = judge.verdict(self._session.scene.start)
        silent = verdict.worst is None
        found: BudgetSoFar = {
            "name": name,
            "seen": figure(verdict.worst, verdict.unit),
            "limit": limit(verdict.limit, verdict.unit, verdict.which),
            "margin": figure(verdict.margin, verdict.unit),
            "state": "" if silent or verdict.verdict == NOT_JUDGED else "fail" if verdict.verdict == FAIL else "pass",
        }
        if verdict.which in PER_MILLE and not silent:
            self._percentiles[name] = now, found
        return found

    def _lateness(self) -> Lateness | None:
        pacer = self._pacer
        if not sum(pacer.counts):
            return None
        return {
            "steps": [*STEPS],
            "counts": [*pacer.counts],
            "worst": pacer.worst,
            "p99": pacer.percentile(0.99),
            "late": pacer.late,
            "slips": pacer.slips,
            "tolerated": TOLERATED,
            "when_late": pacer.when_late,
        }
