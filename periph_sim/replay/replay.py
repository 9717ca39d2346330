"""Base classes of replays. They run and repeat a replay, and create its report and its picture.

scene, capture --run--> wires --compare--> Comparison --+--> Report
          \\--run again, up to the last divergence--> history of flags
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from time import perf_counter
from typing import Any

from ..bus.edge_player import OneWayWire
from ..core.tolerance import Tolerance, in_seconds
from ..records.recording import Subscribe
from ..scene.case.model import Case
from ..scene.scene import Scene
from ..traces.capture.capture import Capture
from ..traces.decode import i2c
from ..traces.decode.i2c_table import I2cRowKind
from .divergence_history import AS_SLAVE, with_history
from .picture import LINES, Side, divergence_picture, last_agreed
from .report import Comparison, Divergence, Happened, Report, i2c_words
from .setup import Played, alone, answering, events_of, played, tolerance_of
from .wire_log import WireLog

Progress = Callable[[float], None]
STEPS = 100  # number of progress reports of `_play`


class Replay:
    """A capture played against the firmware of a unit.

    lead: seconds from the start of the firmware to the beginning of the capture.

    KIND, LOOP, ROLE: the values of `kind`, `loop` and `role` in the report.
    SIDE: the module whose history is recorded, and the registers by which the firmware causes events.
    origin: the tick at which the capture begins.
    """

    KIND, LOOP, ROLE = "i2c", "closed", "slave"
    SIDE = AS_SLAVE
    _repeated: Callable[..., Replay]  # creates the same replay once more, with another `subscribe`

    def __init__(self, scene: Scene, unit: str, lead: Fraction) -> None:
        self.scene = scene
        self._unit = unit
        self.kernel = scene.kernel
        self.timebase = scene.timebase
        self.origin = scene.start + scene.timebase.ticks(lead, "nearest")

    def run(self, progress: Progress | None = None) -> Report:
        """Play the capture, compare the replay with it, and return the report."""
        wall = perf_counter()
        stuck = self._drive(progress)
        self._wall = perf_counter() - wall
        self._result = self.scene.run(Fraction(0))
        return self._report([stuck] if stuck else [])

    def _drive(self, progress: Progress | None = None, until: int | None = None) -> str:
        """Play the capture to its end, or up to tick `until`.

        Return the reason why the replay ended early; "" if it did not.
        """
        raise NotImplementedError

    def _report(self, stuck: list[str]) -> Report:
        """Compare the replay with the capture, and return the report. stuck: notes on why the replay ended early."""
        raise NotImplementedError

    def picture(self, report: Report) -> str | None:
        """Return a picture of the first divergence as SVG text; None if there is no divergence."""
        if not report.divergences:
            return None
        divergence, name = report.divergences[0], Path(report.capture).name
        title = f"{report.case}, {name}, {report.loop} loop: event {divergence.index + 1} of {report.events}"
        return divergence_picture(divergence, title, *self.sides(divergence))

    def sides(self, divergence: Divergence) -> tuple[Side, Side, float]:
        """Return (capture, replay, length of a bit in seconds) for a picture of the divergence."""
        raise NotImplementedError

    def _play(self, end: int, progress: Progress | None) -> None:
        """Run up to tick `end`, and report progress on the way."""
        begin = self.kernel.now
        for step in range(1, STEPS + 1):
            self.kernel.run_until(begin + (end - begin) * step // STEPS)
            if progress is not None:
                progress(step / STEPS)

    def repeat(self, subscribe: Subscribe, until: int, prepare: Callable[[Scene], None] = lambda scene: None) -> Scene:
        """Repeat the run up to tick `until` with a subscriber to its records. Return the scene of this run.

        prepare: a function that is called with the scene before the run.
        """
        again = self._repeated(subscribe=subscribe)
        prepare(again.scene)
        again._drive(until=until)
        return again.scene

    def _summary(self, path: Path, outcome: Comparison, after: int, notes: list[str], **figures: Any) -> Report:
        """Return the report.

        after: the number of ticks after a divergence for which its history is shown.
        figures: the other fields of the report.
        """
        scene, kernel = self.scene, self.kernel
        return Report(
            case=scene.case.name,
            capture=str(path),
            kind=self.KIND,
            loop=self.LOOP,
            role=self.ROLE,
            agreed=outcome.agreed,
            first_divergence=outcome.divergence,
            divergences=with_history(outcome.ranked, scene, self.origin, after, self._unit, self.SIDE, self.repeat),
            lag_worst_us=float(outcome.lag * 1_000_000),
            simulated_s=float(self.timebase.seconds(kernel.now - scene.start)),
            wall_s=round(self._wall, 6),
            kernel_events=kernel.events,
            unknowns=self._result.unknowns,
            notes=notes + self._result.notes,
            **figures,
        )


class BusReplay(Replay):
    """A replay of SCL and SDA.

    log: the edges of SCL and SDA. In an open loop, only the capture drives these wires. The chip drives two other wires
        (`OneWayWire.back`), and the log has the edges of those.
    """

    NAME = "replay"  # name of the replayed side in a picture
    _filled: list[str]  # names of the settings taken from the capture
    _compared: tuple[Sequence[Happened], Sequence[Happened]]
    _replayed: Capture

    def __init__(self, scene: Scene, unit: str, lead: Fraction, part: Played, tolerance: Tolerance | None) -> None:
        super().__init__(scene, unit, lead)
        self._part = part
        self._tolerance = None if tolerance is None else in_seconds(tolerance, scene.units[unit].clock.hz)
        self._per_position = scene.timebase.per_second / part.rate
        self._wires = scene.wire("SCL"), scene.wire("SDA")
        self.log = WireLog(*(wire.back if isinstance(wire, OneWayWire) else wire for wire in self._wires))

    def _bus_summary(
        self,
        outcome: Comparison,
        replayed: Sequence[i2c.Event],
        addresses: Sequence[int],
        tolerance: Fraction,
        notes: list[str],
        **figures: Any,
    ) -> Report:
        """Return the report. replayed: the events of the replay. figures: other fields of the report."""
        part = self._part
        return self._summary(
            part.capture.path,
            outcome,
            int(9 * (part.low + part.high) * self._per_position),
            notes,
            events=len(self._compared[0]),
            filled=self._filled,
            captured_events=len(events_of(part.whole)),
            captured_transfers=len(part.whole),
            tolerance_us=float(tolerance * 1_000_000),
            bytes=sum(event.kind in (I2cRowKind.ADDRESS, I2cRowKind.DATA) for event in replayed),
            addresses=[f"{address:02X}" for address in addresses],
            nacks=sum(event.kind is I2cRowKind.NACK for event in replayed),
            captured_stretch_us=float(part.stretch / part.rate * 1_000_000),
            lag_samples=float(outcome.lag * part.sample_rate),
            **figures,
        )

    def _decoded(self) -> tuple[list[i2c.Event], list[Happened]]:
        """Decode the log of the wires up to now. Return its events, and the same events as texts with times."""
        self._replayed = self.log.capture(self.timebase, self.kernel.now)
        events = i2c.events(self._replayed, *LINES)
        return events, i2c_words(events, Fraction(self.timebase.per_second), self.origin)

    def sides(self, divergence: Divergence) -> tuple[Side, Side, float]:
        part = self._part
        was, came = last_agreed(divergence, *self._compared)
        captured = Side("capture", tuple(zip(LINES, part.lines, strict=True)), part.rate, 0, part.transfers, was)
        wires = tuple((name, self._replayed.channel(name)) for name in LINES)
        transfers, transfers_at = self._replayed_transfers()
        per_second = Fraction(self.timebase.per_second)
        replayed = Side(self.NAME, wires, per_second, self.origin, transfers, came, transfers_at)
        return captured, replayed, part.bit

    def _replayed_transfers(self) -> tuple[Sequence[i2c.Transfer], tuple[Fraction, int] | None]:
        """Return the transfers of the replay, and the pair (rate, origin) of their positions.

        rate: positions per second. origin: the position at which the capture begins. If the positions are ticks, as in
        `log`, None is returned instead of the pair.
        """
        return i2c.transfers(self._replayed, *LINES), None


class SlaveReplay(BusReplay):
    """A replay in which the firmware is a target. The arguments are those of `I2cReplay`."""

    def __init__(
        self,
        case: Case,
        capture: Capture,
        scl: str | int,
        sda: str | int,
        addresses: Sequence[int],
        first: int | None,
        subscribe: Subscribe | None,
        tolerance: Tolerance | None,
        lead: Fraction,
    ) -> None:
        self._first = first
        part = played(capture, scl, sda, first)
        self._answering = found = answering(case, part, addresses, lead)
        prepared, self._filled = alone(case, found.unit, "controller", found.forced, found.offered)
        super().__init__(self._build(case, prepared, subscribe), found.unit, lead, part, tolerance)
        self._allowed = tolerance_of(self._tolerance, part.sample_rate, self.scene)

    def _build(self, case: Case, prepared: Case, subscribe: Subscribe | None) -> Scene:
        """Return the scene. prepared: the case as `alone` returns it."""
        return Scene(prepared, subscribe)
