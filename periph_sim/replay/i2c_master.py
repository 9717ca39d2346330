"""The F28335 as master against captured targets, whose answers are played when the firmware addresses them.

    capture --> the script --> firmware's settings --> unit --> SCL, SDA <-- ScriptedTarget <-- captured answers
       \\--> events expected  <-------------- compare -------------->  events decoded from the wires

Firmware whose `REPLAY` names `script` repeats the transfers of the captured controller, with its `pauses`, `low` and
`high` if `REPLAY` names these. Other firmware runs its own program for as long as the capture lasts. Events are
compared in order. Their times are compared only if a tolerance is given, because the pauses of a driver differ from
those of the captured controller.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from time import perf_counter
from typing import TYPE_CHECKING

from ..bus.i2c.scripted_target import ScriptedTarget
from ..core.chip import NEVER
from ..core.time import Timebase
from ..scene.case.model import Case
from ..scene.scene import Scene
from ..traces.capture.capture import Capture
from ..traces.decode import i2c as decode
from . import BadReplay
from .compare import compare, i2c_words
from .divergence_history import AS_MASTER, CaptureOrigin, FlagHistory, with_history
from .i2c_script import as_master
from .i2c_setup import HOLD, PATIENCE, STEP, TAIL, events_of, played
from .picture import closed_loop_picture
from .report import Report, verdict_of
from .scene_setup import LEAD, alone, settings_of, taken, unit_with
from .wire_log import WireLog

if TYPE_CHECKING:
    from ..records.recording import Subscribe

MODULE_HZ = 10_000_000  # module clock that TI's start-up code sets; I2CCLKL and I2CCLKH count its cycles
D = 5  # cycles that the module adds to each (SPRUG03B Table 15)
MOST = 0xFFFF
EDGES = 2 * 4 * 9  # limit of edges of SCL and SDA for each event: twice the maximum in the nine bits of a byte


class I2cMasterReplay:
    """Replay of one capture on one case.

    first: number of transfers to replay; None for all.
    tolerance: the allowed difference in time of an event, in seconds; None: times are not compared.
    patience: time in seconds. The replay of firmware with a script ends when the bus has been silent for the longest
        pause of the script plus this time.

    Raises BadCase or BadReplay if it cannot be built; LookupError if there is no such channel.
    """

    def __init__(
        self,
        case: Case,
        capture: Capture,
        scl: str | int,
        sda: str | int,
        first: int | None = None,
        subscribe: Subscribe | None = None,
        tolerance: Fraction | None = None,
        patience: Fraction = PATIENCE,
    ) -> None:
        self._given = (case, capture, scl, sda, first)
        self._patience = patience
        self._tolerance = tolerance
        self._part = part = played(capture, scl, sda, first)
        self._unit = unit = unit_with(case, "I2C-A")
        timebase = Timebase(*(int(one.oscclk * one.pll / 2) for one in case.unit.values()))
        self._per_position = timebase.per_second / part.rate
        self._half = half = as_master(part.transfers, part.long_low, self._per_position)
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
        self._filled = taken(case, unit, offered)
        self._scene = scene = Scene(alone(case, unit, "controller", {}, offered), subscribe)
        self.kernel = scene.kernel
        self.origin = scene.start + (0 if self._scripted else scene.timebase.ticks(LEAD, "nearest"))
        self.log = WireLog(scene.wire("SCL"), scene.wire("SDA"))
        ScriptedTarget(scene.kernel, scene.wire("SCL"), scene.wire("SDA"), half.answers, scene.timebase.ticks(HOLD))
        self._silence = scene.timebase.ticks(max(pauses) + patience, "nearest")
        self._most_edges = EDGES * len(events_of(half.done))
        self._notes = list(part.notes)
        if half.left_out:
            self._notes.append(f"omitted transfers, which this module cannot do as master: {self._why()}")

    def _why(self) -> str:
        return "; ".join(f"{times} ({why})" for why, times in self._half.left_out.items())

    # Running ------------------------------------------------------------------------

    def run(self, progress: Callable[[float], None] | None = None) -> Report:
        """Run until the firmware has returned or is no longer waited for, and compare."""
        wall = perf_counter()
        stuck = self._drive(progress)
        return self._report(perf_counter() - wall, [stuck] if stuck else [])

    def _drive(self, progress: Callable[[float], None] | None = None, until: int | None = None) -> str:
        """Run to the end, or up to tick `until`. Return what the firmware does then if its script is not over."""
        kernel, scene = self.kernel, self._scene
        step = scene.timebase.ticks(STEP, "nearest")
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
        """Return why firmware with a script is not waited for any longer; empty while it is, or without a script."""
        if not self._scripted:
            return ""
        if self.kernel.now - self.log.last_edge > self._silence:
            silence = self._scene.timebase.show(self._silence)
            return f", after {silence} without an edge; --patience sets this limit"
        if self.log.edge_count > self._most_edges:
            return ", with more than twice the edges that its script needs"
        return ""

    def _again(self, history: FlagHistory, until: int) -> None:
        again = I2cMasterReplay(*self._given, subscribe=history.subscribe, patience=self._patience)
        history.watch(again._scene)
        again._drive(until=until)

    # Summing up ---------------------------------------------------------------------

    def _report(self, wall: float, stuck: list[str]) -> Report:
        scene, kernel, part = self._scene, self.kernel, self._part
        result = scene.run(Fraction(0))
        replayed = self.log.capture(scene.timebase, kernel.now)
        events = decode.events(replayed, "SCL", "SDA")
        expected = events_of(self._half.done)
        if not self._scripted:
            events = events[: len(expected)]  # it continues with its next round
        self._replayed = replayed
        was = i2c_words(expected, part.rate)
        came = i2c_words(events, Fraction(scene.timebase.per_second), self.origin)
        self._compared = was, came
        outcome = compare(was, came, self._tolerance)
        byte = int(9 * (part.low + part.high) * self._per_position)
        place = CaptureOrigin(scene, self.origin, byte)
        return Report(
            case=scene.case.name,
            capture=str(part.capture.path),
            kind="i2c",
            role="master",
            verdict=verdict_of(bool(outcome.ranked or stuck), asked=True),
            events=len(expected),
            agreed=outcome.agreed,
            captured_events=part.captured_events,
            transfers=len(self._half.done),
            captured_transfers=len(part.whole),
            filled=self._filled,
            first_divergence=outcome.divergence,
            divergences=with_history(outcome.ranked, place, self._unit, AS_MASTER, self._again),
            tolerance_us=float((self._tolerance or Fraction(0)) * 1_000_000),
            bytes=sum(isinstance(event, decode.Address | decode.Data) for event in events),
            addresses=[f"{address:02X}" for address in sorted(self._half.answers)],
            nacks=sum(isinstance(event, decode.Nack) for event in events),
            captured_stretch_us=float(part.stretch / part.rate * 1_000_000),
            lag_worst_us=float(outcome.lag * 1_000_000),
            lag_samples=float(outcome.lag * part.sample_rate),
            simulated_s=float(scene.timebase.seconds(kernel.now - scene.start)),
            wall_s=round(wall, 6),
            kernel_events=kernel.events,
            unknowns=result.unknowns,
            notes=stuck + self._notes + result.notes,
        )

    def picture(self, report: Report) -> str | None:
        """Return the first divergence of a run as SVG text; None without any."""
        return closed_loop_picture(
            report, self._part.capture, self._given[2:4], self._part, self._replayed, self.origin, self._compared
        )


def _cycles(length: Fraction) -> int:
    """Return I2CCLKL or I2CCLKH for a low or high time in seconds."""
    return min(MOST, max(1, round(length * MODULE_HZ) - D))
