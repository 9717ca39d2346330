"""The result of a run: the figures and notes that tables and `--json` show."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

from ..core.chip import joined
from ..core.phrases import counted
from ..timing.verdict import FAIL, NOT_JUDGED, PASS, Verdict
from .case.inputs_table import InputsTable
from .case.optimizations import obsolete_fidelity

if TYPE_CHECKING:
    from ..devices.chips.register_chip import RegisterChip
    from ..f28335.descriptor import ModuleDescriptor
    from ..f28335.gpio.module import Gpio
    from ..f28335.i2c.module import I2c
    from ..processor.dsp import Dsp
    from .scene import Scene


# The key of the number of skipped polls in `Result.counts`. It describes the work of the simulator, not the case.
SKIPPED = "polls_skipped"
BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")  # a TOML key that needs no quotes


@dataclass
class Result:
    """The result of a run.

    verdict: "fail" if a budget is broken or not judged, if firmware waits for an event that cannot occur, if firmware
        or a device let no simulated time pass, or if the controller still waits for a line that another party holds
        low. Otherwise "pass", or "not judged" if the case has no budgets.
    wall_s: seconds of real time of the run, without the time to build the scene.
    wire_bytes: number of complete bytes on the I2C bus, including addresses (`Scene.bytes_on_bus`). With a controller
        agent, and no outside party on the bus, the bytes of units that are masters, too, do not count.
    bytes_skipped: number of I2C bytes whose first seven bits were simulated in one step.
    sci_bytes: number of characters that the host, the parties in [serial] and an outside party sent to SCIs of units.
    sci_bytes_sent: number of characters that SCIs of units sent.
    sci_errors: number of characters that SCIs of units received with each kind of error; empty without an SCI.
    estimated: names of the units that run C sources. The cycles between the accesses of these units are estimated.
    stuck: sentences about lines that stayed low, at most ten (without a controller agent, only if `stuck` is measured),
        and about firmware that waits for an event that cannot occur, or code that let no simulated time pass.
    wrong: the number of wrong bytes that were read, by place, such as "gyroscope byte 0". Places without wrong bytes
        are left out.
    first_wrong: a sentence about the first read with a wrong byte; "" if there is none.
    ends: a sentence for each unit with an image about what the image does at the end of the run. There is no sentence
        for units whose image has ended, nor for units whose firmware is named in `stuck`.
    """

    case: str
    verdict: str
    simulated_s: float
    wall_s: float
    events: int
    wire_bytes: int
    sci_bytes: int
    budgets: list[Verdict]
    counts: dict[str, int]
    unknowns: list[str]
    notes: list[str]
    stuck: list[str]
    wrong: dict[str, int] = field(default_factory=dict)
    first_wrong: str = ""
    estimated: list[str] = field(default_factory=list)
    sci_bytes_sent: int = 0
    sci_errors: dict[str, int] = field(default_factory=dict)
    bytes_skipped: int = 0
    ends: list[str] = field(default_factory=list)
    fidelity: str = "exact"  # obsolete, always "exact"; kept for programs that read the output of `--json`

    def reception(self, zero: bool = False) -> list[str]:
        """Return a phrase for each kind of error in characters that SCIs received: `5 framing errors`.

        zero: True to include the kinds of errors that did not occur.
        """
        return [counted(count, error) for error, count in self.sci_errors.items() if count or zero]


ON_THE_HOST = (
    "its C sources run on the host, where int has 32 bits, long and pointers 64, char 8 (on the chip 16, 32, 22, 16), "
    "and addresses count bytes"
)


def result_of(scene: Scene, length: int, wall: float) -> Result:
    """Return the result of a run of `length` ticks, which took `wall` seconds."""
    masters = _other_masters(scene)
    if masters:
        for limit in scene.limits:
            limit.leave_out_bus(
                f"{' and '.join(masters)} sent as a master, but the events are those of [controller] only"
            )
    verdicts = [limit.verdict(scene.start) for limit in scene.limits]
    deadlocks = scene.deadlocks()
    stuck = [*scene.stuck.sentences[:10], *deadlocks]
    failed = not all(v.passed for v in verdicts) or bool(deadlocks) or scene.stuck.hangs()
    counts = {"rounds": 0, "missed": 0, "nacked": scene.bus.nacked, "frames": 0, "stuck": len(scene.stuck.sentences)}
    if scene.head is not None:
        counts |= {"rounds": scene.head.rounds, "missed": scene.head.missed}
    elif scene.bus.asked is not None:
        counts |= {"rounds": scene.bus.rounds.completed, "missed": scene.bus.rounds.missed}
    if scene.host is not None:
        counts |= {"frames": scene.host.frames}
    if scene.frames is not None:
        counts["beyond_16_bits"] = scene.frames.beyond.total()
    counts["overruns"] = max((x.measure.count for x in scene.limits if x.budget.measure == "overruns"), default=0)
    counts[SKIPPED] = sum(dsp.program.polls_skipped for dsp in scene.units.values())
    counts["resets"] = sum(dsp.resets for dsp in scene.units.values())
    compared = None if scene.derived is None else scene.derived.bytes  # None if no bytes are compared
    return Result(
        case=scene.case.name,
        verdict=FAIL if failed else PASS if verdicts else NOT_JUDGED,
        simulated_s=float(scene.timebase.seconds(length)),
        wall_s=round(wall, 6),
        events=scene.kernel.events,
        wire_bytes=scene.bytes_on_bus(),
        sci_bytes=scene.uart.characters + (0 if scene.host is None else scene.host.bytes),
        sci_bytes_sent=scene.uart.sent_by_units(),
        sci_errors=scene.uart.errors(),
        budgets=verdicts,
        counts=counts,
        unknowns=unknowns(scene),
        notes=notes_of(scene),
        stuck=stuck,
        wrong={} if compared is None else compared.wrong_places,
        first_wrong="" if compared is None else compared.first_wrong,
        bytes_skipped=min(scene.bus.passed, scene.bytes_on_bus()),
        estimated=[name for name, unit in scene.case.unit.items() if unit.sources],
        ends=[
            f"{name} {scene.doing(dsp)}"
            for name, dsp in scene.units.items()
            if scene.case.unit[name].image and not dsp.program.finished
            if not any(sentence.startswith(f"{name} ") for sentence in deadlocks)
        ],
    )


def unknowns(scene: Scene) -> list[str]:
    """Return the sorted names of the options whose answers a run has used, as `UNIT.GROUP.OPTION` or `CHIP.OPTION`."""
    parts: dict[str, Dsp | RegisterChip] = {
        **scene.units,
        **{name: on_bus.chip for name, on_bus in scene.chips.items()},
    }
    return sorted({f"{name}.{t}" for name, part in parts.items() for t in part.touched})


def touched_sets(scene: Scene) -> Iterator[set[str]]:
    """Yield the sets in which the units and chips of a scene collect the names of the options that they use."""
    for dsp in scene.units.values():
        yield dsp.core.touched
        yield from (socket.chip.touched for socket in dsp.sockets.values())
    yield from (on_bus.chip.touched for on_bus in scene.chips.values())


def notes_of(scene: Scene) -> list[str]:
    """Return the notes of the run, one line each: on case, units, chips, devices, faults, rounds, host and lines."""
    obsolete = [obsolete_fidelity(scene.case.fidelity)] if scene.case.fidelity else []
    lines = [*obsolete, *scene.case.replaced, *([scene.log_ends_early] if scene.log_ends_early else [])]
    for name, dsp in scene.units.items():
        for module, socket in dsp.sockets.items():
            for tick, note in joined(socket.notes) if socket.notes else ():
                at = scene.timebase.show(tick - scene.start)
                place = dsp.note_places.get((socket.name, tick))
                where = f", {place.for_people()}" if place else ""
                text = note.text.removeprefix(f"{module}: ")  # the line has the name of the module already
                lost = f" ({counted(dsp.lost_counts[note], 'time')})" if note in dsp.lost_counts else ""
                lines.append(f"{name} {module}, first at {at}{where}: {text} [{note.source}]{lost}")
        for note, n in dsp.processor.notes.counts.items():
            place = dsp.processor.notes.places.get(note)
            where = f", {'first ' * (n > 1)}at {place.for_people()}" if place else ""
            if note.code == "overflow":
                at = scene.timebase.show(dsp.processor.notes.first_at[note] - scene.start)
                where = f", first at {at}" + (f", {place.for_people()}" if place else "")
            lines.append(f"{name}: {note.text} [{note.source}] ({counted(n, 'time')}{where})")
        if dsp.watchdog_resets:
            first, place = dsp.watchdog_resets[0]
            where = f" at {place}" if place else ""
            at = scene.timebase.show(first - scene.start)
            lines.append(
                f"{name}: its watchdog reset it{where}, first at {at} ({counted(len(dsp.watchdog_resets), 'time')})"
            )
        if "GPIO" in dsp.sockets:
            lines += unwired_pins(dsp)
        if scene.case.unit[name].sources:
            lines.append(f"{name}: {ON_THE_HOST}")
        if dsp.program.returned_at is not None:
            at = scene.timebase.show(dsp.clock.tick(dsp.program.returned_at) - scene.start)
            lines.append(f"{name}: {dsp.program.ending(at)}")
    for name, party in scene.note_logs().items():
        for note, (tick, times) in party.notes.items():
            at = scene.timebase.show(tick - scene.start)
            lines.append(f"{name}, first at {at}: {note.text} [{note.source}] ({counted(times, 'time')})")
    for fault in scene.faults:
        if not fault.has_occurred:
            at = scene.timebase.show(fault.next_at - scene.start)
            lines.append(f"{fault.who} never occurred: its time, {at}, is after the end of the run")
    return lines + _late_parties(scene) + _missed_rounds(scene) + scene.uart.notes()


def _other_masters(scene: Scene) -> list[str]:
    """Return the names of the units' I2C modules that made a START, if the bus records lack their events.

    The records lack these events if the simulated controller makes the records. Without a controller, or if an outside
    party drives the bus, the records come from the wires and have the events of all masters; return [] then.
    """
    if scene.head is None or scene.head.controller.beside_others:
        return []
    modules = [(name, *one) for name, dsp in scene.units.items() for one in dsp.sockets.items()]
    i2c = [(f"{name}.{module}", socket) for name, module, socket in modules if module.startswith("I2C")]
    return [name for name, socket in i2c if cast("I2c", socket.chip).master.starts]


def _late_parties(scene: Scene) -> list[str]:
    """Return a note for a controller or host whose first round or frame is at or after the end of the case.

    Its start is the first in the list of [inputs], or without such a list the key `first` of the party.
    """
    case, timebase, inputs = scene.case, scene.timebase, scene.case.inputs or InputsTable()
    end = timebase.show(timebase.ticks(case.duration, "nearest"))
    parties = (("controller", "round", case.controller, inputs.rounds), ("host", "frame", case.host, inputs.frames))
    return [
        f"{name}: its first {what}, at {timebase.show(timebase.ticks(first, 'nearest'))}, is after the end of the "
        f"case, {end}"
        for name, what, table, starts in parties
        if table is not None
        for first in (starts[:1] if starts is not None else (table.first,))
        if first >= case.duration
    ]


def _missed_rounds(scene: Scene) -> list[str]:
    """Return a note on the number of missed rounds of the controller; none if a budget limits this number."""
    head, table = scene.head, scene.case.controller
    judged = any(part.budget.measure == "missed rounds" for limit in scene.limits for part in limit.parts)
    if head is None or table is None or not head.missed or judged:
        return []
    period = scene.timebase.show(scene.timebase.ticks(table.period, "nearest"))
    rounds = counted(head.missed, "round")
    which = (
        f"{rounds} did not begin when due"
        if scene.bus.starts
        else f"{rounds} that were due every {period} did not begin"
    )
    return [f"controller: {which}, because the one before was still running; a budget on 'missed rounds' judges that"]


def unwired_pins(dsp: Dsp) -> list[str]:
    """Return a note for each module with a signal for which the case has no wire.

    Such a signal is connected by GPxMUX to one or more pins at the end of the run, but none of these pins has a wire.
    Modules on the I2C bus are not checked.
    """
    gpio, part = cast("Gpio", dsp.sockets["GPIO"].chip), dsp.plan.part
    notes = []
    for module in dsp.sockets:
        descriptor = part.by_name[module]
        if descriptor.bus:
            continue
        pins = {end: pins_of(gpio, descriptor, signal) for end, signal in descriptor.wires.items()}
        bare = {end: min(on) for end, on in pins.items() if on and not set(on) & set(dsp.plan.wires)}
        if bare:
            places = " and ".join(f"{end} on GPIO{pin}" for end, pin in bare.items())
            keys = ", ".join(
                f"{_key(dsp.plan.wires[part.pins[descriptor.wires[end]]].name)} = {pin}" for end, pin in bare.items()
            )
            notes.append(
                f"{dsp.name}: {module} has {places}, where the case has no wire; add pins = {{ {keys} }} to the unit"
            )
    return notes


def pins_of(gpio: Gpio, descriptor: ModuleDescriptor, signal: str) -> tuple[int, ...]:
    """Return the pins that GPxMUX connects to a signal."""
    if signal in descriptor.outputs:
        return gpio.sink(signal)
    source = gpio.source(signal)
    return () if source is None else (source,)


def _key(name: str) -> str:
    """Return a name as a TOML key, quoted unless it consists of letters A to Z, digits, "_" and "-"."""
    return name if BARE_KEY.fullmatch(name) else json.dumps(name, ensure_ascii=False)
