"""The scene of a case: its wires, units, agents and measures, which are built, run and judged.

    Case --> Scene --run--> Result
             wires SDA, SCL, RX, TX; units; sensor head; host; budgets

A scene has only the parts that the case names: without a [controller], for example, there is no sensor head.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property, partial
from time import perf_counter
from typing import TYPE_CHECKING
from weakref import finalize, proxy

from ..core.kernel import Kernel
from ..core.records import Kind, Recorder
from ..core.time import Timebase, TimeError
from ..core.uncollected import uncollected
from ..processor.user_code import FirmwareStalled
from ..timing.language.scope import BadEvent
from . import parts
from .bus_side import SPIKE, BusSide
from .case.model import Case
from .context import SceneContext, SceneWires
from .plan import ScenePlan
from .result import Result, result_of
from .stuck_lines import StuckLines, doing
from .uart_side import UartSide

if TYPE_CHECKING:
    from ..bus.faults import Repeated
    from ..bus.i2c.line_observers import BusRecorder
    from ..bus.i2c.transfer import Transfer
    from ..core.chip import Note
    from ..core.snapshot import Snapshot
    from ..core.wire import Wire
    from ..devices.chips.register_chip import Source
    from ..devices.host_frames import FrameSource
    from ..devices.host_pc import Host
    from ..devices.sensor_head import SensorHead
    from ..devices.sensor_rounds import Request, Round
    from ..devices.truth import Truth
    from ..processor.dsp import Dsp
    from ..timing.budgets import BudgetJudge
    from ..timing.measures.measure import MeasuredScene
    from ..timing.verdict import Verdict
    from .devices import DeviceOnBus, NoteLog
    from .firmware_loader import Firmware
    from .host import HostAgent
    from .sensor_chips import ChipOnBus
    from .serial.side import SerialSide
    from .unit import FirmwareModel

NEEDS = {"rounds": "[controller], or [rounds] for a unit that is the master,"}


class Scene:
    """A built scene. Deleting it terminates its firmware.

    case: the case, or the case's plan if several scenes are built from the plan.
    subscribe: a function that is called with the recorder of the records and the timebase while the scene is built. It
        can subscribe to records before anything runs.
    programs: a dictionary from a unit to firmware that is given as a Python function. For this unit, the key `firmware`
        in the case is then only a name.
    keep_values: True to keep all values of measures that have a series of values, for `BudgetJudge.values`.
    sources: a dictionary from a sensor chip to a function of the tick that returns the chip's input; it replaces the
        key `values` of the chip's table.
    restorable: True to log the accesses of C sources, so that `restore` need not run the scene from its start. No
        effect if a unit runs Python firmware.
    """

    WIRES = SceneWires

    @uncollected()
    def __init__(
        self,
        case: Case | ScenePlan,
        subscribe: Callable[[Recorder, Timebase], None] | None = None,
        programs: Mapping[str, Firmware] | None = None,
        *,
        keep_values: bool = False,
        sources: Mapping[str, Source] | None = None,
        restorable: bool = False,
    ) -> None:
        plan = case if isinstance(case, ScenePlan) else ScenePlan(case)
        self.case = case = plan.case
        self.recorder = Recorder()
        wiring, scope, ticks = plan.wiring, plan.scope, plan.ticks
        self.timebase, self.start = ticks.timebase, ticks.start
        self.limits: list[BudgetJudge] = []
        if case.budget:
            from ..timing.budgets import BudgetJudge

            for limit_plan in plan.limits:
                self.limits.append(BudgetJudge(limit_plan, self.timebase, self.limits))
        for limit in self.limits:
            if keep_values and limit.measure.series:
                limit.measure.keep()
            for measure in limit.own_measures:
                measure.subscribe(self.recorder)
        serial: SerialSide | None = None
        if case.serial is not None:
            from .serial.side import SerialSide

            serial = SerialSide(case, case.serial, scope, self.recorder)
        if subscribe is not None:
            subscribe(self.recorder, self.timebase)
        has_named = any(map(self.recorder.named_things, Kind))
        self.derived = parts.derived_records.DerivedRecords(self.recorder) if has_named else None
        self.kernel = Kernel(self.start)
        self.wires = self.WIRES(self.kernel, self.recorder)
        self.units: dict[str, Dsp] = {}
        # No part may refer to the scene: waiting firmware refers to parts, so the scene would never be deleted.
        self._close = finalize(self, _let_go, self.recorder, self.units)
        self._close.atexit = False
        self.firmware: dict[str, Firmware] = {}  # maps a unit to its firmware
        self.chips: dict[str, ChipOnBus] = {}
        self.devices: dict[str, DeviceOnBus] = {}
        self.faults: list[Repeated] = []
        self.head: SensorHead | None = None
        self.requests: list[Request] = []  # the reads and writes that the controller makes in every round
        self.host: Host | None = None
        self.host_agent: HostAgent | None = None
        self.truth: Truth | None = None
        self.model: FirmwareModel | None = None  # the model with which firmware computes the data of chips
        self.frames: FrameSource | None = None  # source of the host's frames; None if the host has no motion
        # `_counter` counts the bytes on the wires. It is None without a bus, or if only the controller agent drives the
        # bus as a master; then, `bus` counts the bytes of the agent.
        self._counter: BusRecorder | None = None
        self.bus = BusSide(case, self.wires, self.timebase.ticks(SPIKE, "nearest"))
        self.stuck = StuckLines(self.kernel, self.timebase, self.start, self.units)
        self.log_ends_early = ""  # a sentence if the log in [outside] is cut off before its end; else ""
        self.stalled = ""  # a sentence if the run was aborted because user code let no simulated time pass; else ""
        # The last snapshot with logs of the accesses of C sources. `restore` of another scene can start from it.
        self.checkpoint: Snapshot | None = None
        self._wall = 0.0  # seconds of real time that the run has taken
        wire = self.wires.wire
        context = SceneContext(case, self.timebase, self.start, self.kernel, self.recorder, wire, wiring)
        self._context, self._serial = context, serial
        for name in case.unit:
            program = (programs or {}).get(name)
            self.units[name], self.firmware[name], model = parts.unit.build_unit(
                context, name, plan.unit(name), program
            )
            self.model = self.model or model
        self.keeps_logs = restorable and parts.state.keep_logs(self)
        self._build_targets(context, sources or {})
        outside = case.outside
        shared = outside is not None and parts.outside_parties.drives_bus(outside)  # an outside party drives the bus
        if case.controller is not None:
            self.head = self.stuck.head = parts.controller.build_head(
                context, case.controller, plan.head, self.stuck.report
            )
            self.requests, self.bus.asked = list(plan.head.requests), plan.head.asked
            self.head.controller.beside_others = shared
            if not shared:
                self.head.on_transfer.append(self.bus.count)
        has_bus = "SCL" in self.wires and "SDA" in self.wires
        if has_bus and parts.controller.skips_bits(context):
            agent = None if self.head is None else self.head.controller
            self.bus.bit_skip = parts.controller.bit_skip_of(context, agent, self.units)
        if has_bus and (self.head is None or shared):
            from ..bus.i2c.line_observers import BusRecorder

            self._counter = BusRecorder(self.wires["SCL"], self.wires["SDA"])
        if case.rounds is not None:
            if "SCL" not in self.wires:
                raise case.mistake("it needs a bus, and no unit has I2C-A", "rounds")
            self.bus.asked = parts.controller.rounds_of(context, case.rounds)
        if has_bus and (shared or case.rounds is not None):
            self.on_transfer(self.bus.count_nacked)
        if case.host is not None:
            self.host_agent = parts.host.HostAgent(context, case.host, plan.host, self.model)
            self.host = self.host_agent.host
            self.frames, self.truth = self.host_agent.frames, self.host_agent.truth
        for transceiver in case.transceiver:
            self.wires.wire(transceiver.pair)
        if case.fault:
            self.faults = parts.faults.build_faults(context, self.wires, self.units)
        measured = None if serial is None else self.measured
        self.uart = UartSide(context, self.wires, self.units, self.host_agent, serial, measured)
        self._there = {  # for each part that measures may need: True if this scene has it
            "": True,
            "controller": self.head is not None,
            "rounds": self.bus.asked is not None,
            "I2C-A": "SCL" in self.wires,
            "host": self.host is not None,
            "SCI": self.uart.has_sci,
            "serial": self.case.serial is not None,
        }
        for entry, limit in enumerate(self.limits):
            for part in limit.parts:
                self._check_needs(entry, part)
        if self.derived is not None:
            self.derived.attach(proxy(self))
        for entry, limit in enumerate(self.limits):
            for measure in limit.own_measures:
                try:
                    measure.listen(self.measured)
                except BadEvent as error:
                    raise case.mistake(str(error), "budget", entry, "measure") from None
        if outside is not None:
            parts.outside_parties.check_outside(case, self.wires)
            self.uart.count(outside.wires)
            if outside.log is not None:
                log = parts.outside_log.logged_outside(context, self.wires)
                log.on_sent = self.uart.sent
                self.log_ends_early = log.unfinished

    # Building the scene ------------------------------------------------------------------

    def _check_needs(self, entry: int, limit: BudgetJudge) -> None:
        """Raise BadCase if a budget can never be broken, because the scene or case lacks something that it needs.

        entry: the index of the budget in the case. limit: the judge of the budget, or of one of its conditions.
        """
        needs = limit.measure.needs
        if not self._there[needs]:
            measure = limit.budget.measure
            what = f"{measure!r} needs {NEEDS.get(needs, needs)} in the scene, which has none"
            raise self.case.mistake(what, "budget", entry, "measure")

    @cached_property
    def measured(self) -> MeasuredScene:
        """The values and functions of this scene that measures use. Without measures, their modules are not loaded."""
        return parts.measured_parts.measured_scene(self._context, self.wires, self.units, self.bus, self._serial)

    def wire(self, name: str) -> Wire:
        return self.wires.wire(name)

    def _build_targets(self, context: SceneContext, sources: Mapping[str, Source]) -> None:
        """Build the sensor chips and the other devices on SCL and SDA."""
        taken: dict[int, str] = {}  # maps an address to its chip or device
        for name, table in self.case.chip.items():
            chip = self.chips[name] = parts.sensor_chips.build_chip(context, name, sources.get(name), taken)
            parts.devices.put_on_bus(context, name, table, chip)
        if self.case.device:
            try:
                self.devices = parts.devices.build_devices(context, self.wires, taken)
            except FirmwareStalled as stalled:  # the code of a user's device did not return, so nothing can run
                self.stalled = str(stalled)
        if self.case.strict:
            for name, log in self.note_logs().items():
                log.on_note = partial(_raise_in_firmware, self.units, name)

    def note_logs(self) -> dict[str, NoteLog]:
        """Return a dictionary from the name of a chip or device to the log of its notes."""
        chips = {name: chip.log for name, chip in self.chips.items()}
        return chips | {name: device.log for name, device in self.devices.items()}

    # Events and figures for measures and displays -------------------------------

    def on_transfer(self, callback: Callable[[Transfer], None]) -> None:
        self.bus.rounds.on_transfer.append(callback)

    def on_round(self, callback: Callable[[Round], None]) -> None:
        self.bus.rounds.on_round.append(callback)

    def on_frame(self, callback: Callable[[int, tuple[int, ...], int], None]) -> None:
        if self.host is not None:
            self.host.sent.append(callback)

    def bytes_on_bus(self) -> int:
        """Return the number of complete bytes on the I2C bus, including addresses.

        The bytes are counted on the wires if there is no controller agent, or if an outside party also drives the bus.
        Otherwise, only the bytes in the transfers of the controller agent are counted, and not those of other masters.
        """
        if self._counter is not None:
            return self._counter.bytes
        return self.bus.wire_bytes + (0 if self.head is None else self.head.controller.bytes_under_way())

    # Running the scene --------------------------------------------------------------------

    def doing(self, dsp: Dsp) -> str:
        """Return what a unit's firmware does now, as a phrase."""
        return doing(dsp, self.timebase, self.start)

    def run(self, duration: Fraction | None = None, progress: Callable[[float], None] | None = None) -> Result:
        """Run for `duration` seconds, or for the case's duration if it is None, and return the result.

        progress: called up to a hundred times, with the fraction of the run that is done.

        If the case has the log of a session in [outside], the run leaves out the events of the tick at which it ends,
        because the session left out those of the tick at which it ended.

        Raise BadCase, before anything runs, if the run would have too many ticks, or if the case has an [outside]
        without a log.
        """
        outside = self.case.outside
        if outside is not None and outside.log is None:
            raise parts.outside_parties.not_run(self.case)
        began = self.kernel.now
        try:
            end = self.timebase.end_of_run(began, self.case.duration if duration is None else duration)
        except TimeError as error:
            raise self.case.mistake(str(error), "duration") from None
        length = end - began
        steps = 100 if progress is not None else 1
        for step in range(1, steps + 1):
            self.advance(began + length * step // steps - (outside is not None))
            if progress is not None and not self.stalled:
                progress(step / steps)
        return self.finish(length)

    def advance(self, until: int) -> None:
        """Run all events up to and including tick `until`. Do nothing if the run was aborted (`stalled`)."""
        if self.stalled:
            return
        wall = perf_counter()
        try:
            if self.keeps_logs:
                parts.state.run_to_checkpoint(self, until)
            self.kernel.run_until(until)
        except FirmwareStalled as stalled:
            self.stalled = str(stalled)
        self._wall += perf_counter() - wall

    def state(self) -> Snapshot:
        """Return a snapshot of the scene between two runs. It has plain values, with times relative to the present.

        A snapshot does not contain measures, nor the stacks of Python firmware and C sources. If all units run images,
        two scenes with equal snapshots continue equally.
        """
        return parts.state.state_of_scene(self)

    def restore(self, snapshot: Snapshot) -> None:
        """Continue from a snapshot of another scene with equal case, programs and records. Call it before any run.

        If all units run images, the state is assigned, and budgets begin anew. Otherwise, the scene runs from its start
        to the time of the snapshot, because stacks of Python firmware and C sources cannot be restored. If both scenes
        are `restorable`, C sources are first executed up to a checkpoint shortly before the snapshot. In this time, the
        values that they read come from logs of their accesses. The scene then runs only from the checkpoint, and
        budgets begin there.

        Raise NotRestorable, with nothing changed, if the case, a program or the records are not equal, if this scene
        has run already, or if the accesses of C sources differ from those in their logs. Raise NotRestorable also if
        the state after the run differs from the snapshot.
        """
        parts.state.restore_scene(self, snapshot)

    def close(self) -> None:
        """Terminate the firmware and remove all subscribers. The scene can then be read, but not run.

        A scene is closed automatically when it is deleted. It is never deleted if one of its subscribers refers to it.
        """
        self._close()

    def finish(self, length: int) -> Result:
        """End the run and return its result.

        length: the number of ticks of the run. If firmware stalled, only the ticks before the stall count.
        """
        length = min(length, self.kernel.now - self.start) if self.stalled else length
        self.kernel.materialize()
        self.bus.finish(self.kernel.now)
        self.uart.finish(self.kernel.now)
        if self.derived is not None:
            self.derived.finish(self)
        for limit in self.limits:
            limit.finish(self.kernel.now)
        return result_of(self, length, self._wall)

    def clocks(self) -> Mapping[str, Sequence[tuple[int, Fraction]]]:
        """Return, for each unit, pairs (tick, SYSCLKOUT in Hz from then on): at the start and at each change."""
        return {name: unit.clock_history for name, unit in self.units.items()}

    def typical(self) -> list[Verdict]:
        """Return the least critical occurrence of each budget, as verdicts. Call it after `run`.

        Budgets with fewer than two occurrences, or with one number for the whole run, are left out.
        """
        found = (limit.typical(self.start) for limit in self.limits)
        return [verdict for verdict in found if verdict is not None]

    def deadlocks(self) -> list[str]:
        """Return a sentence for each unit whose firmware waits for an event that cannot occur."""
        return parts.deadlock.deadlocks_of(self)


def _raise_in_firmware(units: Mapping[str, Dsp], name: str, note: Note) -> None:
    """Raise an error in the firmware for a note of the chip or device `name`, because the case is `strict`."""
    for dsp in units.values():
        dsp.processor.notes.raise_if_strict(note, name, dsp.processor.kernel.now)


def _let_go(recorder: Recorder, units: Mapping[str, Dsp]) -> None:
    """Close the recorder and terminate the programs of a deleted scene."""
    recorder.close()
    for dsp in units.values():
        dsp.program.release()
