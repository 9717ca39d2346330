"""A running scene: a case goes in; wires, units, agents and measures are built, run, and summed up.

    Case --> Scene --run--> Result
             wires SDA, SCL, RX, TX; units; sensor head; host; budgets

It builds only what the case names: no host, no RX wire; no controller, no agent.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial
from time import perf_counter
from typing import TypeVar

from ..case.model import Budget, Case, ChipTable, Controller, HostTable, RequestTable, Unit
from ..core.chip import NEVER
from ..core.kernel import Kernel
from ..core.nearest import near
from ..core.options import Value, options_from
from ..core.records import Recorder
from ..core.time import Timebase
from ..core.wire import Wire
from ..devices.host_frame import MotionFrames
from ..devices.host_pc import Host, HostSchedule, ramp
from ..devices.models.parameters import Imu
from ..devices.register_chip import Source
from ..devices.sensor_head import CHIPS, Request, Round, Schedule, SensorHead
from ..devices.truth import Axes, LineBetweenFrames, MotionFelt, Truth
from ..f28335.i2c_options import I2cOptions
from ..f28335.sci_options import SciOptions
from ..f28335.system_options import SystemOptions
from ..lines.i2c_controller import BusTiming, I2cController, Transfer
from ..lines.i2c_counter import I2cCounter
from ..lines.i2c_target_side import TargetSide
from ..lines.uart_peer import UartPeer
from ..timing.budgets import BadBudget, Limit, Verdict
from ..timing.measures import WrongBytes
from ..timing.names import Scope, scope_of_case
from ..timing.value_measures import ValueDeviation
from .chips import Chip, ChipOnBus, build_chip
from .dsp import MODULES, PIN_OF, Dsp, DspPlan
from .firmware import BadFirmware, BadSetting, Firmware, load_firmware, sensors_of, settings_for
from .host_motion import encoding_of, frames_of
from .i2c_follower import I2cFollower
from .result import Result
from .sci_watch import SciWatch
from .stuck import hopeless

T = TypeVar("T")

I2C_PINS = {"SDA": PIN_OF["SDAA"], "SCL": PIN_OF["SCLA"]}
SCI_PINS = {"RX": PIN_OF["SCIRXDA"], "TX": PIN_OF["SCITXDA"]}


class Scene:
    """subscribe: called while the scene is built, before anything runs; recorders subscribe there.

    programs: firmware given as Python functions, by unit; of these units the case's `firmware` is only a name.
    keep_values: of measures that take one value after the other, for `timing.values`.
    sources: what chips feel, given as functions of the tick, by chip; they stand in for the case's `values`.
    """

    def __init__(
        self,
        case: Case,
        subscribe: Callable[[Recorder, Timebase], None] | None = None,
        programs: Mapping[str, Firmware] | None = None,
        *,
        keep_values: bool = False,
        sources: Mapping[str, Source] | None = None,
    ) -> None:
        self.case = case
        self._programs = programs or {}
        self.timebase = Timebase(*(int(unit.oscclk * unit.pll / 2) for unit in case.unit.values()))
        self.recorder = Recorder()
        scope = scope_of_case(case)
        self.start = self.timebase.ticks(case.start, "nearest")
        self.limits = [self._limit(i, budget, scope) for i, budget in enumerate(case.budget)]
        for limit in self.limits:
            if keep_values and limit.measure.series:
                limit.measure.keep()
            for part in limit.parts:
                self.recorder.subscribe(part.measure.kinds, part.measure.record, part.measure.subjects)
        if subscribe is not None:
            subscribe(self.recorder, self.timebase)
        self.kernel = Kernel(self.start)
        self.wires: dict[str, Wire] = {}
        self.units: dict[str, Dsp] = {}
        self.chips: dict[str, ChipOnBus] = {}
        self.head: SensorHead | None = None
        self.requests: list[Request] = []  # of each of its rounds
        self.host: Host | None = None
        self.truth: Truth | None = None
        self.sensors: Imu | None = None  # whose values firmware computes, where it has models
        self.frames: MotionFrames | None = None  # what the host sends, where it is no ramp
        self.wire_bytes = 0  # by the controller agent
        self._counter: I2cCounter | None = None  # where there is none
        self._transfers_in_round = 0
        self._startup_transfers = 0
        self.nacked = 0
        self.stuck_lines: list[str] = []
        self._stuck_wire: Wire | None = None  # the line last reported stuck, and how many rounds were over then
        self._stuck_after_rounds = 0
        self._stuck_told: list[Callable[[int], None]] = []
        self._sci_watches: dict[str, SciWatch] = {}
        for name, unit in case.unit.items():
            self.units[name] = self._build_unit(name, unit)
        targets = [self._build_chip(name, table, (sources or {}).get(name)) for name, table in case.chip.items()]
        if case.controller is not None:
            self.head = self._build_head(case.controller)
            self.head.on_transfer.append(self._count_transfer)
            for dsp in self.units.values():
                if dsp.has("I2C-A"):
                    self.head.controller.followers.append(I2cFollower(dsp, self.wires["SCL"], self.wires["SDA"]))
            self.head.controller.followers += targets
        elif "SCL" in self.wires:
            self._counter = I2cCounter(self.wires["SCL"], self.wires["SDA"])
        if case.host is not None:
            self.host = self._build_host(case.host)
        for entry, limit in enumerate(self.limits):
            for part in limit.parts:
                self._check_needs(entry, part)
                part.measure.listen(self)

    # Building ------------------------------------------------------------------

    def _limit(self, entry: int, budget: Budget, scope: Scope) -> Limit:
        if any(other.name == budget.name for other in self.case.budget[:entry]):
            what = f"there are two budgets {budget.name!r}; verdicts are known by name, so give one another name"
            raise self.case.mistake(what, "budget", entry, "name")
        try:
            return Limit(budget, self.timebase, scope, self.start)
        except BadBudget as error:
            raise self.case.mistake(str(error), "budget", entry, *error.place) from None

    def _check_needs(self, entry: int, limit: Limit) -> None:
        """A budget on what this scene cannot have would always hold: it is a mistake, not a pass."""
        there = {
            "": True,
            "controller": self.head is not None,
            "host": self.host is not None,
            "SCI-A": any(dsp.has("SCI-A") for dsp in self.units.values()),
        }
        needs = limit.measure.needs
        if not there[needs]:
            measure = limit.budget.measure
            raise self.case.mistake(
                f"{measure!r} needs {needs} in the scene, which has none", "budget", entry, "measure"
            )
        if isinstance(limit.measure, ValueDeviation) and self.truth is None:
            what = f"{limit.budget.measure!r} of sensor models needs a motion to compare with; give [host.motion]"
            raise self.case.mistake(what, "budget", entry, "measure")

    def wire(self, name: str) -> Wire:
        if name not in self.wires:
            self.wires[name] = Wire(self.kernel, name, self.recorder)
        return self.wires[name]

    def _build_unit(self, name: str, unit: Unit) -> Dsp:
        wires: dict[int, Wire] = {}
        if "I2C-A" in unit.modules:
            wires |= {pin: self.wire(wire) for wire, pin in I2C_PINS.items()}
        if "SCI-A" in unit.modules:
            wires |= {pin: self.wire(wire) for wire, pin in SCI_PINS.items()}
        for label, pin in unit.pins.items():
            wires[pin] = self.wire(label)
        for module in unit.modules:
            if module not in MODULES:
                hint = near(module, MODULES)
                raise self.case.mistake(f"there is no module {module!r}; {hint}", "unit", name, "modules")
        plan = DspPlan(
            name,
            unit.modules,
            wires,
            oscclk_hz=int(unit.oscclk),
            pll=unit.pll,
            ppm=unit.ppm,
            from_boot=unit.from_boot,
            skip_polls=unit.skip_polls,
            strict=self.case.strict,
            system=self._options(SystemOptions, unit.options.system, name, "system"),
            i2c=self._options(I2cOptions, unit.options.i2c, name, "i2c"),
            sci=self._options(SciOptions, unit.options.sci, name, "sci"),
        )
        dsp = Dsp(self.kernel, self.timebase, self.recorder, plan)
        try:
            firmware = self._programs.get(name) or load_firmware(unit.firmware)
        except BadFirmware as error:
            raise self.case.mistake(str(error), "unit", name, "firmware") from None
        try:
            settings = settings_for(firmware, unit.settings)
        except BadSetting as error:
            inside = (error.name,) if error.name else ()  # none: about several together
            raise self.case.mistake(str(error), "unit", name, "settings", *inside) from None
        self.sensors = self.sensors or sensors_of(settings)
        dsp.start(partial(firmware.main, dsp, settings))
        return dsp

    def _build_chip(self, name: str, table: ChipTable, source: Source | None) -> TargetSide:
        chip = self.chips[name] = build_chip(self.case, name, self.kernel, self.recorder, self.timebase, source)
        return chip.attach(self.wire("SCL"), self.wire("SDA"), self._ticks(table.output_delay))

    def _options(self, kind: type[T], given: dict[str, Value], unit: str, group: str) -> T:
        """Answers to open questions; each is checked by itself, so that a mistake is told with its line."""
        for name, value in given.items():
            try:
                options_from(kind, {name: value})
            except ValueError as error:
                raise self.case.mistake(str(error), "unit", unit, "options", group, name) from None
        return options_from(kind, given)

    def _ticks(self, length: Fraction) -> int:
        return self.timebase.ticks(length, "nearest")

    def _build_head(self, table: Controller) -> SensorHead:
        half = Fraction(1, 2) / table.rate
        low = self._ticks(half if table.low is None else table.low)
        high = self._ticks(half if table.high is None else table.high)
        timing = BusTiming(low, high, self._ticks(table.hold), high, low, high, low)
        controller = I2cController(
            self.kernel,
            self.recorder,
            self.wire("SCL"),
            self.wire("SDA"),
            timing,
            who="controller",
            stuck_after=self._ticks(table.stuck_after),
            on_stuck=self._stuck,
        )
        schedule = Schedule(
            first=self._ticks(table.first),
            period=self._ticks(table.period),
            gap=self._ticks(table.gap),
            jitter=self._ticks(table.jitter),
            rounds=table.rounds,
            ahead=self._ticks(table.initialise or Fraction(0)),
        )
        requests = [self._chip(name, "controller", "order") for name in table.order]
        requests += [self._request(i, request) for i, request in enumerate(table.request)]
        if not requests:
            raise self.case.mistake("it has no requests; give it order or [[controller.request]]", "controller")
        by_stop = table.pointer_by == "STOP"
        self._transfers_in_round = sum(len(request.transfers(by_stop)) for request in requests)
        startup: list[Request] = []
        if table.initialise is not None:
            asked = {request.address for request in requests}
            startup = [request for chip in CHIPS.values() if chip.address in asked for request in chip.startup]
            if not startup:
                raise self.case.mistake(
                    "no known chip is asked, so there is none to set up", "controller", "initialise"
                )
        self._startup_transfers = sum(len(request.transfers(by_stop)) for request in startup)
        self.requests = requests
        return SensorHead(
            self.kernel, controller, requests, schedule, startup=startup, by_stop=by_stop, seed=self.case.seed
        )

    def _chip(self, name: str, *place: str | int) -> Request:
        if name not in CHIPS:
            raise self.case.mistake(f"there is no chip {name!r}; {near(name, CHIPS)}", *place)
        chip = CHIPS[name]
        return Request(name, chip.address, chip.pointer, 6)

    def _request(self, entry: int, table: RequestTable) -> Request:
        if table.chip is not None:
            known = self._chip(table.chip, "controller", "request", entry, "chip")
            return replace(known, name=table.name or known.name, expect=table.expect)
        assert table.address is not None
        name = table.name or f"{table.address:#04x}"
        return Request(name, table.address, table.pointer, table.count, table.write, table.expect)

    def _build_host(self, table: HostTable) -> Host:
        bit = self.timebase.per_second / (Fraction(table.baud) * (1 + table.error / 100))
        peer = UartPeer(self.kernel, self.recorder, self.wire("RX"), bit)
        schedule = HostSchedule(
            first=self._ticks(table.first),
            period=self._ticks(table.period),
            jitter=self._ticks(table.jitter),
            gap=table.gap,
            lose=frozenset(table.lose),
            frames=table.frames,
        )
        encoding = self._host_settings("encoding", lambda: encoding_of(table.encoding))
        if table.motion:
            frames = partial(frames_of, table.motion, encoding, table.first, table.period)
            self.frames = self._host_settings("motion", frames)
        self.truth = self._truth_of(table)
        seed = self.case.seed + 1
        return Host(self.kernel, peer, schedule, self.frames or ramp, seed, encoding.byte_order)

    def _truth_of(self, table: HostTable) -> Truth | None:
        """What chips should show. None where models make it of frames of which no motion is known."""
        if self.sensors is None:
            return LineBetweenFrames(self.frames or ramp, table.period)
        return None if self.frames is None else MotionFelt(self.sensors, self.frames.motion, table.first)

    def _host_settings(self, table: str, build: Callable[[], T]) -> T:
        try:
            return build()
        except BadSetting as error:
            raise self.case.mistake(str(error), "host", table, *filter(None, [error.name])) from None

    # What measures listen to ----------------------------------------------------

    def listen_transfers(self, told: Callable[[Transfer], None]) -> None:
        if self.head is not None:
            self.head.on_transfer.append(told)

    def listen_rounds(self, told: Callable[[Round], None]) -> None:
        if self.head is not None:
            self.head.on_round.append(told)

    def listen_frames(self, told: Callable[[int, tuple[int, ...], int], None]) -> None:
        if self.host is not None:
            self.host.sent.append(told)

    def listen_stuck(self, told: Callable[[int], None]) -> None:
        self._stuck_told.append(told)

    def listen_sci(self, told: Callable[[int, int, bool], None]) -> None:
        for name, dsp in self.units.items():
            if dsp.has("SCI-A"):
                if name not in self._sci_watches:
                    self._sci_watches[name] = SciWatch(dsp)
                self._sci_watches[name].told.append(told)

    def checks_host(self) -> bool:
        return self.case.controller is not None and self.case.controller.check == "host"

    def listen_missed(self, told: Callable[[int], None]) -> None:
        if self.head is not None:
            self.head.on_missed.append(told)

    def transfers_in_round(self) -> int:
        return self._transfers_in_round

    def startup_transfers(self) -> int:
        return self._startup_transfers

    def round_period(self) -> int:
        return 0 if self.case.controller is None else self._ticks(self.case.controller.period)

    def began(self) -> int:
        return self.start

    def level_of(self, wire: str) -> int:
        return self.wires[wire].level

    def value_of(self, place: str, name: str) -> int:
        unit, _, module = place.partition(".")
        chip = self.units[unit].socket(module).chip
        register_name, _, field_name = name.partition(".")
        register = chip.MAP[register_name]
        cycle = self.units[unit].clock.cycle_at(self.kernel.now)
        touched = frozenset(chip.touched)
        value = chip.peek(cycle, register.offset)
        if register.width == 32:
            value |= chip.peek(cycle, register.offset + 1) << 16
        chip.touched.intersection_update(touched)  # looking is not depending on them
        return register[field_name].of(value)

    def ticks_per_second(self) -> int:
        return self.timebase.per_second

    def sysclk(self, unit: str) -> Fraction:
        return self.units[unit or next(iter(self.units))].clock.hz

    def cpu_cycles(self, unit: str) -> tuple[int, int]:
        dsp = self.units[unit]
        return dsp.cpu.busy_cycles, dsp.clock.cycle_at(self.kernel.now)

    def host_values(self, number: int) -> tuple[int, ...]:
        return (self.frames or ramp)(number)

    def frame_due(self, number: int) -> int:
        assert self.case.host is not None
        return self.start + self._ticks(self.case.host.first) + number * self._ticks(self.case.host.period)

    def truth_at(self, tick: int) -> Mapping[str, Axes]:
        assert self.truth is not None
        return self.truth.at(self.timebase.seconds(tick - self.frame_due(0)))

    def _count_transfer(self, transfer: Transfer) -> None:
        self.wire_bytes += transfer.wire_bytes
        self.nacked += not transfer.acked

    def _stuck(self, wire: Wire) -> None:
        who = " and ".join(wire.held_by()) or "nobody"
        at = self.timebase.show(self.kernel.now - self.start)
        doing = "; ".join(f"{name} {self.doing(dsp)}" for name, dsp in self.units.items())
        self.stuck_lines.append(f"{wire.name} is held low by {who} at {at}: {doing}")
        if self.head is not None:
            self._stuck_wire, self._stuck_after_rounds = wire, self.head.rounds
        for told in self._stuck_told:
            told(self.kernel.now)

    # Running --------------------------------------------------------------------

    def doing(self, dsp: Dsp) -> str:
        """What a unit's firmware does now, as a phrase."""
        if dsp.cpu.finished:
            return "has returned from main"
        spin = dsp.cpu.spin_now
        if spin is None:
            return "waits in IDLE for an interrupt" if dsp.core.idlestat else "computes"
        since = self.timebase.show(dsp.clock.tick(spin.since) - self.start)
        return f"waits for {spin.waits_for()} since {since}"

    def run(self, duration: Fraction | None = None, progress: Callable[[float], None] | None = None) -> Result:
        """Run for `duration` seconds (the case's own if None) and sum up. progress: told the part done, 0 to 1."""
        length = self.timebase.ticks(self.case.duration if duration is None else duration, "nearest")
        began = self.kernel.now
        wall = perf_counter()
        steps = 100 if progress is not None else 1
        for step in range(1, steps + 1):
            self.kernel.run_until(began + length * step // steps)
            if progress is not None:
                progress(step / steps)
        wall = perf_counter() - wall
        for limit in self.limits:
            limit.finish(self.kernel.now)
        return self._result(length, wall)

    def typical(self) -> list[Verdict]:
        """Of each budget that took several values, the one furthest from its limit, as a verdict. After `run`."""
        found = (limit.typical(self.start) for limit in self.limits)
        return [verdict for verdict in found if verdict is not None]

    def deadlocks(self) -> list[str]:
        """Firmware that waits for what cannot come, a sentence each: for what, since when, why it cannot."""
        told = []
        for name, dsp in self.units.items():
            why = hopeless(dsp, self._may_move)
            if why:
                told.append(f"{name} {self.doing(dsp)} and would for ever: {why}")
        return told

    def _may_move(self, wire: Wire, parties: list[str]) -> bool:
        """Whether one of these parties has something left to do, or an agent among them has done all it was to do."""
        if self.kernel.next_time() < NEVER:
            return True
        asking = self.head is not None and not self.head.at_rest
        return any(who.partition(".")[0] not in self.units and not (asking and who == "controller") for who in parties)

    def hangs(self) -> bool:
        """A line that was reported stuck is still held by somebody else than the controller, in the same round."""
        wire, head = self._stuck_wire, self.head
        if wire is None or head is None or head.at_rest or head.rounds != self._stuck_after_rounds:
            return False
        return any(who != head.who for who in wire.held_by())

    def _result(self, length: int, wall: float) -> Result:
        verdicts = [limit.verdict(self.start) for limit in self.limits]
        deadlocks = self.deadlocks()
        stuck = [*self.stuck_lines[:10], *deadlocks]
        failed = any(v.verdict == "fail" for v in verdicts) or bool(deadlocks) or self.hangs()
        counts = {"rounds": 0, "missed": 0, "nacked": self.nacked, "frames": 0, "stuck": len(self.stuck_lines)}
        if self.head is not None:
            counts |= {"rounds": self.head.rounds, "missed": self.head.missed}
        if self.host is not None:
            counts |= {"frames": self.host.frames}
        if self.frames is not None:
            counts["beyond_16_bits"] = self.frames.beyond.total()
        counts["overruns"] = sum(x.measure.count for x in self.limits if x.budget.measure == "overruns")
        counts["polls_skipped"] = sum(dsp.cpu.polls_skipped for dsp in self.units.values())
        counts["resets"] = sum(dsp.resets for dsp in self.units.values())
        parts: dict[str, Dsp | Chip] = {**self.units, **{name: on_bus.chip for name, on_bus in self.chips.items()}}
        wrong: dict[str, int] = {}
        first_wrong = ""
        for limit in self.limits:
            if isinstance(limit.measure, WrongBytes):
                wrong, first_wrong = limit.measure.where, limit.measure.first
        return Result(
            case=self.case.name,
            verdict="fail" if failed else "pass",
            fidelity=self.case.fidelity,
            simulated_s=float(self.timebase.seconds(length)),
            wall_s=round(wall, 6),
            events=self.kernel.events,
            wire_bytes=self.wire_bytes if self._counter is None else self._counter.bytes,
            sci_bytes=0 if self.host is None else self.host.bytes,
            budgets=verdicts,
            counts=counts,
            unknowns=sorted({f"{name}.{t}" for name, part in parts.items() for t in part.touched}),
            notes=self._notes(),
            stuck=stuck,
            wrong=wrong,
            first_wrong=first_wrong,
        )

    def _notes(self) -> list[str]:
        lines = []
        for name, dsp in self.units.items():
            for module, socket in dsp.sockets.items():
                for cycle, note in socket.notes:
                    at = self.timebase.show(dsp.clock.tick(cycle) - self.start)
                    lines.append(f"{name} {module}, first at {at}: {note.text} [{note.source}]")
            lines += [f"{name}: {note.text} [{note.source}] ({n} times)" for note, n in dsp.cpu.notes.items()]
        for name, chip in self.chips.items():
            for note, (tick, times) in chip.notes.items():
                at = self.timebase.show(tick - self.start)
                lines.append(f"{name}, first at {at}: {note.text} [{note.source}] ({times} times)")
        return lines
