"""The F28335 as master with captured targets, whose answers are played when the firmware addresses them.

    capture --> transfers as script --> settings --> unit --> SCL, SDA <-- ScriptedTarget <-- captured answers
       \\--> events expected  <-------------- compare -------------->  events decoded from the wires

Firmware that lists `script` in `REPLAY` repeats the transfers of the captured controller. If it also lists `pauses`,
`low` and `high`, it repeats the captured pauses between transfers and the low and high times of SCL. Other firmware
runs its own program for as long as the capture lasts. Events are compared in order. Their times are compared only if a
tolerance is given, because the pauses of a driver differ from those of the captured controller.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial

from ..bus.i2c.replayed_sides import ScriptedTarget
from ..core.chip import NEVER
from ..core.time import Timebase
from ..core.tolerance import Tolerance
from ..records.recording import Subscribe
from ..scene.case.model import Case
from ..scene.scene import Scene
from ..traces.capture.capture import Capture
from . import BadReplay
from .divergence_history import AS_MASTER
from .i2c_script import as_master
from .replay import BusReplay, Progress
from .report import Report, compare, i2c_words, verdict_of
from .setup import HOLD, LEAD, PATIENCE, STEP, TAIL, alone, events_of, played, settings_of, unit_with

MODULE_HZ = 10_000_000  # module clock in Hz, set by TI's start-up code; I2CCLKL and I2CCLKH count its cycles
D = 5  # cycles that the module adds to each of I2CCLKL and I2CCLKH (SPRUG03B Table 15)
MOST = 0xFFFF  # largest value of I2CCLKL and I2CCLKH
EDGES = 2 * 4 * 9  # maximum number of edges per event: twice the four edges of SCL and SDA in each of nine bits


class I2cMasterReplay(BusReplay):
    """Replay of an I2C capture in which the firmware, as master, replaces the captured controller.

    scl, sda: the names or numbers of the channels.
    first: the maximum number of transfers; None for all.
    tolerance: the allowed difference in time of an event; None: times are not compared.
    patience: a time in seconds. If the firmware has a script, the replay ends when the bus has been silent for the
        longest pause of the script plus this time.

    Raise BadCase, BadReplay or another InputError if the replay cannot be built; LookupError if a channel is missing.
    """

    ROLE = "master"
    SIDE = AS_MASTER

    def __init__(
        self,
        case: Case,
        capture: Capture,
        scl: str | int,
        sda: str | int,
        first: int | None = None,
        subscribe: Subscribe | None = None,
        tolerance: Tolerance | None = None,
        patience: Fraction = PATIENCE,
    ) -> None:
        self._repeated = partial(I2cMasterReplay, case, capture, scl, sda, first, patience=patience)
        part = played(capture, scl, sda, first)
        unit = unit_with(case, "I2C-A")
        timebase = Timebase(*(int(one.oscclk * one.pll / 2) for one in case.unit.values()))
        self._half = half = as_master(part.transfers, part.long_low, timebase.per_second / part.rate)
        if not half.script:
            raise BadReplay(f"{capture.path}: no transfer that this module can do as master: {self._why()}")
        self._scripted = "script" in settings_of(case, unit)
        pauses = [pause / part.rate for pause in half.pauses]
        offered: dict[str, object] = {
            "script": half.script,
            "pauses": pauses,
            "low": _cycles(part.low / part.rate),
            "high": _cycles(part.high / part.rate),
        }
        prepared, self._filled = alone(case, unit, "controller", {}, offered)
        scene = Scene(prepared, subscribe)
        super().__init__(scene, unit, Fraction(0) if self._scripted else LEAD, part, tolerance)
        ScriptedTarget(scene.kernel, *self._wires, half.answers, scene.timebase.ticks(HOLD))
        self._silence = scene.timebase.ticks(max(pauses) + patience, "nearest")
        self._most_edges = EDGES * len(events_of(half.done))
        self._notes = list(part.notes)
        if half.left_out:
            self._notes.append(f"omitted transfers, which this module cannot do as master: {self._why()}")

    def _why(self) -> str:
        return "; ".join(f"{times} ({why})" for why, times in self._half.left_out.items())

    # Running the replay ------------------------------------------------------------------------

    def _drive(self, progress: Progress | None = None, until: int | None = None) -> str:
        """Run to the end, or up to tick `until`.

        If the script is unfinished, return a phrase that says what the firmware is doing; otherwise return "".
        """
        kernel, scene = self.kernel, self.scene
        step = self.timebase.ticks(STEP, "nearest")
        length = int(self._part.capture.length * self._per_position)
        unit = scene.units[self._unit]
        endless = ""
        while (until is None or kernel.now <= until) and not endless:
            due = kernel.next_time()
            if due >= NEVER or unit.program.finished or (not self._scripted and kernel.now > self.origin + length):
                break
            kernel.run_until(max(kernel.now, due) + step)
            if progress is not None:
                progress(min(1.0, (kernel.now - self.origin) / length))
            endless = self._endless()
        if unit.program.finished or not self._scripted:
            kernel.run_until(kernel.now + scene.timebase.ticks(TAIL, "nearest"))
            return ""
        return f"{self._unit} {scene.doing(unit)}: the replay ends there{endless}"

    def _endless(self) -> str:
        """Return a phrase that says why a replay ends before its script is over; "" to continue."""
        if not self._scripted:
            return ""
        if self.kernel.now - self.log.last_edge > self._silence:
            silence = self.timebase.show(self._silence)
            return f", after {silence} without an edge; --patience sets this limit"
        if self.log.edge_count > self._most_edges:
            return ", with more than twice the edges that its script needs"
        return ""

    # The report ---------------------------------------------------------------------

    def _report(self, stuck: list[str]) -> Report:
        part = self._part
        events, found = self._decoded()
        expected = events_of(self._half.done)
        if not self._scripted:  # what the firmware's own program does after the capture's events is not compared
            events, found = events[: len(expected)], found[: len(expected)]
        self._compared = i2c_words(expected, part.rate), found
        outcome = compare(*self._compared, self._tolerance)
        return self._bus_summary(
            outcome,
            events,
            sorted(self._half.answers),
            self._tolerance or Fraction(0),
            stuck + self._notes,
            verdict=verdict_of(bool(outcome.ranked or stuck), asked=True),
            transfers=len(self._half.done),
        )


def _cycles(length: Fraction) -> int:
    """Return the value of I2CCLKL or I2CCLKH for a low or high time in seconds, limited to 1 to MOST."""
    return min(MOST, max(1, round(length * MODULE_HZ) - D))
