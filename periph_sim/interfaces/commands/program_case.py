"""The case that `new image` and `new c` write: a run with all modules and pins shows what the program uses.

program --run with everything--> modules, pins, interrupts, calls --second run, without limits--> figures --> case

The limits of the case are the figures of the second run plus a margin. They describe the program, not what its user
requires.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from os.path import abspath, relpath
from pathlib import Path
from typing import NamedTuple, cast

import click

from ...core.phrases import counted
from ...core.records import Kind, Listener
from ...f28335.gpio.module import Gpio
from ...f28335.gpio.register_map import XINT_FIRST_PIN, XINT_SELECTS
from ...f28335.parts.f28335 import PART
from ...f28335.pie.register_map import LINES, PIEIER, VECTORS
from ...f28335.system_control.register_map import MAP
from ...f28335.xint.module import Xint
from ...processor.dsp import Dsp
from ...processor.image.boot import BEGINS
from ...processor.image.observers import CallListener
from ...processor.image.program import ImageProgram
from ...processor.image_files.model import Image
from ...processor.image_files.program_file import program_in
from ...processor.user_code import output_muted
from ...scene.case.load import case_of
from ...scene.case.model import BadCase
from ...scene.case.wiring import LAST_PIN
from ...scene.result import pins_of
from ...scene.scene import Scene
from ...timing.verdict import duration_text
from ..reports.case_text import Tree, toml, usable_budgets

UNIT = "dsp"
# The run ends at the first of these times, in seconds, at which something can be measured (see OFTEN), or at which the
# program has ended, hangs, or was reset by the watchdog. Otherwise, it ends at the last of these times, or soon after
# MOST_WORK instructions if this is earlier.
STRETCHES = (Fraction(20, 1000), Fraction(100, 1000), Fraction(500, 1000), Fraction(2))
STEP = Fraction(10, 1000)  # seconds of the run after which its instructions are compared with MOST_WORK
MOST_WORK = 1_000_000
ACCESS_WORK = 50  # simulating one access by C sources takes as long as this number of instructions of an image
OFTEN = 3  # minimum number of interrupts, calls or writes of one kind for which a period is measured
MARGIN = 10  # percent by which a limit exceeds the measured figure
SEEN = "seen, not required"
PORT_DATA = re.compile(r"W GPIO\.GP([ABC])(?:DAT|SET|CLEAR|TOGGLE)")
MOST_PINS = 32  # maximum number of GPIO outputs to which the case connects a wire
NOTHING_REPEATS = "nothing repeats, so the case has no budget"
ADD_INPUT = (
    "add what the program waits for: [[serial.send]] for an SCI, [controller] for an I2C slave, [device.NAME] for an "
    "I2C master, [[unit.dsp.stub]] for a register without a model"
)
REPLACED = "GlobalVariableDefs.c"  # end of the name of TI's file that defines the register structures; it is left out


class WrittenCase(NamedTuple):
    """A new case.

    path: the path of the case file, which is not written yet.
    text: the text of the file, as TOML.
    first: the name of the first budget; "" if the case has none.
    notes: sentences for the user.
    """

    path: Path
    text: str
    first: str
    notes: list[str]


@dataclass
class Topic:
    """The records of one kind with the same `where` and `what`.

    records: the number of these records.
    bits: the bits that are 1 in any of their values.
    """

    kind: Kind
    where: str
    what: str
    records: int = 0
    bits: int = 0


class Seen(Listener):
    """Listener that counts the records of each topic and combines the bits of their values."""

    def __init__(self) -> None:
        self._topics: list[Topic] = []

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        self._topics.append(Topic(kind, where, what))
        return len(self._topics) - 1

    def on_record(self, tag: int, tick: int, value: int) -> None:
        topic = self._topics[tag]
        topic.records += 1
        topic.bits |= value

    def of(self, kind: Kind) -> list[Topic]:
        """Return the topics of a kind that have records."""
        return [topic for topic in self._topics if topic.kind is kind and topic.records]


class LoopCalls(CallListener):
    """Listener that stores, for each function that has not returned yet, which functions it has called.

    callees: a dictionary for each function that has not returned yet, the outermost one first. For each function that
        it has called, the dictionary has the number of calls and the tick of the last call.
    """

    def __init__(self) -> None:
        self.callees: list[dict[str, tuple[int, int]]] = []

    def called(self, name: str, tick: int) -> None:
        if self.callees:
            count, _ = self.callees[-1].get(name, (0, 0))
            self.callees[-1][name] = count + 1, tick
        self.callees.append({})

    def returned(self, name: str, tick: int) -> None:
        self.callees.pop()

    def once_per_pass(self, handlers: set[str], since: int) -> str:
        """Return the function that the outermost loop calls once in each pass; "" if no loop calls a function.

        It is assumed to be the function with the fewest calls from the loop; of several, the first. If the loop called
        this function fewer than OFTEN times, return "".

        handlers: names of service routines, which no function calls.
        since: a tick; a function whose last call was not after this tick is not in the loop.
        """
        for callees in self.callees:
            recent = {name: count for name, (count, last) in callees.items() if last > since}
            least = min((name for name in recent if name not in handlers), key=recent.__getitem__, default="")
            if least:
                return least if recent[least] >= OFTEN else ""
        return ""


def image_case(path: Path) -> WrittenCase:
    """Return a case for an image, to be written to the current folder.

    Raise BadImage if the file is no image. Raise ClickException if the file of the new case exists, or if the image
    cannot be run.
    """
    image = program_in(path)
    section, boot = _boot(image)
    unit = {"image": relpath(path), "boot": boot}
    notes = []
    if not image.symbols:
        notes.append(
            "the image has no symbols, so no function has a name; link it with symbols, and compile it with -g"
        )
    return _case(path, unit, [f"boot: {section}"], notes)


def sources_case(path: Path) -> WrittenCase:
    """Return a case for the C sources below a folder. The case file belongs in the current folder.

    Raise ClickException if there is no such folder, no C source below it, or no source that defines main, and
    as `_case` does.
    """
    if not path.is_dir():
        what = "it is no folder" if path.exists() else "there is no such folder"
        raise click.ClickException(f"{path}: {what}; give the folder of the .c files")
    sources = sorted(file for file in path.rglob("*.c") if not file.name.endswith(REPLACED))
    if not sources:
        raise click.ClickException(f"{path}: there is no C source below it; give the folder of the .c files")
    texts = [file.read_text(encoding="utf-8", errors="replace") for file in sources]
    if not any(re.search(r"^\s*(?:\w+\s+)?main\s*\(", text, re.M) for text in texts):
        what = f"{counted(len(sources), 'C source')} below it, but none defines main"
        raise click.ClickException(
            f"{path}: there {'is' if len(sources) == 1 else 'are'} {what}; add the file that does"
        )
    include = dict.fromkeys(relpath(file.parent) for file in sorted(path.rglob("*.h")))
    unit: Tree = {"sources": [relpath(file) for file in sources]}
    if include:
        unit["compile"] = {"include": list(include)}
    return _case(path, unit, [], [])


def _boot(image: Image) -> tuple[str, str]:
    """Return a description of the start of the image, and the value of the key `boot`."""
    for mode, address in BEGINS.items():
        section = next((one for one in image.loaded if one.name == "codestart" and one.address == address), None)
        if section is not None:
            return f"section codestart is at {address:#08x}", mode
    return f"no section codestart where the boot ROM jumps, so it begins at its entry, {image.entry:#08x}", "entry"


@output_muted()
def _case(path: Path, program: Tree, comments: list[str], notes: list[str]) -> WrittenCase:
    """Return the case of a program.

    program: the keys of the case that name the program.
    comments: the first comments at the top of the case; comments about the run follow.
    notes: the first notes for the user; notes about the run follow.

    Raise ClickException if the file of the new case exists, or if the program cannot be built or run.
    """
    name = re.sub(r"[^\w.-]", "_", Path(abspath(path)).stem)  # abspath replaces "." and ".." by the folder's name
    target = Path(f"{name}.toml")
    if target.exists():
        raise click.ClickException(f"{target}: exists already; move it, or type the command in another folder")
    tree: Tree = {"name": name, "duration": f"{STRETCHES[-1]} s"}
    tree["unit"] = {UNIT: {**program, "modules": list(PART.selectable)}}
    seen, calls = Seen(), LoopCalls()
    try:
        scene = Scene(case_of(tree, target), lambda recorder, _: recorder.subscribe((Kind.ACCESS, Kind.IRQ), seen))
    except BadCase as error:  # for example, gcc rejects a source
        # The message begins with the name of the new case, which is left out, because this file is not written.
        raise click.ClickException(
            f"no case was written: {str(error).partition(f'{UNIT}.')[2].partition(': ')[2]}"
        ) from None
    dsp = scene.units[UNIT]
    if isinstance(dsp.program, ImageProgram):
        dsp.program.add_call_listener(calls)
    budgets: list[Tree] = []
    length = Fraction(0)
    for stretch in STRETCHES:
        while length < stretch and _work(dsp, seen) < MOST_WORK:
            length += STEP
            scene.advance(scene.start + scene.timebase.ticks(length, "nearest"))
        if scene.stalled:
            raise click.ClickException(f"{path}: it cannot run, so no case was written: {scene.stalled}")
        tree |= {"duration": duration_text(float(length)), "unit": {UNIT: {**program, **_unit(dsp, seen)}}}
        budgets = _as_seen(tree, target, _measures(scene, dsp, seen, calls))
        if budgets or dsp.program.finished or dsp.watchdog_resets or scene.deadlocks() or length < stretch:
            break
    vectors = (f"vector: {topic.what}{_served_by(dsp, topic.what)}" for topic in seen.of(Kind.IRQ))
    head = [f"A run of {tree['duration']} showed this.", *comments, _clock(dsp), *vectors]
    notes += [*scene.finish(scene.timebase.ticks(length, "nearest")).stuck, *_notes(scene, dsp, seen)]
    if budgets:
        tree["budget"] = budgets
        head.append(f"limits: the largest value of that run plus {MARGIN} %; {SEEN}")
    else:
        waits = not (dsp.program.finished or dsp.watchdog_resets)
        notes.append(f"{NOTHING_REPEATS}; {ADD_INPUT}" if waits else NOTHING_REPEATS)
    text = "".join(f"# {line}\n" for line in head) + re.sub(r"\n{3,}", "\n\n", toml(tree))
    return WrittenCase(target, text, budgets[0]["name"] if budgets else "", notes)


def _unit(dsp: Dsp, seen: Seen) -> Tree:
    """Return the table of a unit: its crystal, the modules that the program has accessed, and pins with a wire."""
    used = {topic.what[2:].partition(".")[0] for topic in seen.of(Kind.ACCESS)}
    modules = [module for module in PART.selectable if module in used]
    pins = _inputs(dsp, modules) | _outputs(dsp, seen)
    return {"oscclk": f"{dsp.plan.oscclk_hz // 1_000_000} MHz", "modules": modules, "pins": pins}


def _work(dsp: Dsp, seen: Seen) -> int:
    """Return how much the run has computed so far, as a number of instructions (see ACCESS_WORK)."""
    if isinstance(dsp.program, ImageProgram):
        return dsp.program.instructions - dsp.program.skipped
    return ACCESS_WORK * sum(topic.records for topic in seen.of(Kind.ACCESS))


def _measures(scene: Scene, dsp: Dsp, seen: Seen, calls: LoopCalls) -> dict[str, str]:
    entered = {topic.what: topic.records // 2 for topic in seen.of(Kind.IRQ)}  # two records: entry and return
    found = {f"latency of {vector}": f"interrupt latency {vector}" for vector in entered}
    found |= {
        f"period of {vector}": f"period of interrupt {vector} enter"
        for vector, count in entered.items()
        if count >= OFTEN
    }
    handlers = {_handler(dsp, vector) for vector in entered}
    function = calls.once_per_pass(handlers, (scene.start + scene.kernel.now) // 2)
    if function:
        found[f"loop that calls {function}"] = f"period of span {json.dumps(function)} begin"
    return found | {f"period of {wire}": f"period of edge {wire} rise" for wire in _outputs(dsp, seen)}


def _inputs(dsp: Dsp, modules: list[str]) -> dict[str, int]:
    """Return a dictionary from wires to their pins, for wires that are not at the pin of the default wiring.

    These are pins that GPxMUX connects to a module in place of the usual pin, and pins of enabled external interrupts.
    """
    gpio = cast(Gpio, dsp.sockets["GPIO"].chip)
    found: dict[str, int] = {}
    for module in modules:
        descriptor = PART.by_name[module]
        for end, signal in descriptor.wires.items():
            pins = pins_of(gpio, descriptor, signal)
            if pins and PART.pins[signal] not in pins:
                found[end if descriptor.plain else f"{module}.{end}"] = min(pins)
    if "XINT" in modules:
        enabled = cast(Xint, dsp.sockets["XINT"].chip).enabled
        for line, select in enumerate(XINT_SELECTS):
            if enabled >> line & 1:
                pin = gpio.peek(dsp.clock.cycle_at(dsp.processor.kernel.now), select) + XINT_FIRST_PIN[line]
                found[f"XINT{line + 1}"] = pin
    return found


def _outputs(dsp: Dsp, seen: Seen) -> dict[str, int]:
    """Return the GPIO outputs that the program changes, at most MOST_PINS, as a dictionary from names to pin numbers.

    An output counts if the program has written it through a register that it has written at least OFTEN times.
    """
    written = 0
    for topic in seen.of(Kind.ACCESS):
        register = PORT_DATA.fullmatch(topic.what)
        if register and topic.records >= OFTEN:
            written |= topic.bits << 32 * "ABC".index(register[1])
    changing = written & cast(Gpio, dsp.sockets["GPIO"].chip).driven
    return {f"GPIO{pin}": pin for pin in [n for n in range(LAST_PIN + 1) if changing >> n & 1][:MOST_PINS]}


def _handler(dsp: Dsp, vector: str) -> str:
    """Return the name of the service routine to which a vector of the PIE vector table points; "" if it is unknown."""
    if not isinstance(dsp.program, ImageProgram):
        return ""
    return dsp.program.functions.name_at(dsp.processor.bus.ram.word32(VECTORS[vector]))


def _served_by(dsp: Dsp, vector: str) -> str:
    handler = _handler(dsp, vector)
    return f", served by {handler}" if handler else ""


def _clock(dsp: Dsp) -> str:
    now, control = dsp.clock.cycle_at(dsp.processor.kernel.now), dsp.control
    pll, divsel = (control.peek(now, MAP[register].offset) for register in ("PLLCR", "PLLSTS"))
    hz = float(control.sysclk_hz)
    return f"clock: PLLCR = {pll}, DIVSEL = {divsel >> 7 & 3}; SYSCLKOUT is {hz / 1e6:g} MHz if the crystal has oscclk"


def _notes(scene: Scene, dsp: Dsp, seen: Seen) -> Iterator[str]:
    """Yield notes on watchdog resets, on enabled interrupts that were not requested, and on the return from main."""
    if dsp.watchdog_resets:
        tick, place = dsp.watchdog_resets[0]
        at = place or scene.timebase.show(tick - scene.start)  # C sources that access nothing have no place
        times = counted(len(dsp.watchdog_resets), "time")
        yield f"its watchdog reset it {times}, first at {at}; disable it (WDCR = 0x68) or service it in the loop"
    entered = {topic.what for topic in seen.of(Kind.IRQ)}
    for vector, (group, line) in LINES.items():
        enabled = dsp.core.ier >> group - 1 & 1 and dsp.pie.peek(0, PIEIER[group - 1].offset) >> line - 1 & 1
        if enabled and vector not in entered:
            asks = ", ".join(PART.requesters(vector)) or "a module without a model"
            yield f"{asks} did not request {vector}{_served_by(dsp, vector)}, which is enabled"
    if dsp.program.returned_at is not None:
        at_end = scene.timebase.show(dsp.clock.tick(dsp.program.returned_at) - scene.start)
        yield f"{dsp.program.ending(at_end)}; a loop in main would keep it running"


def _as_seen(tree: Tree, target: Path, measures: dict[str, str]) -> list[Tree]:
    """Run the case. Return a budget for each measure that has a value, with this value plus MARGIN % as the limit.

    Periods with fewer than OFTEN - 1 values, and measures that do not fit the case, have no budget. GPIO pins without
    an edge in this run are removed from the unit in `tree`.
    """
    named = ({"name": name, "measure": measure, "max": "0 us", "why": SEEN} for name, measure in measures.items())
    found = usable_budgets(tree, target, named)
    seen = Seen()
    scene = Scene(case_of({**tree, "budget": found}, target), lambda recorder, _: recorder.subscribe([Kind.EDGE], seen))
    result = scene.run()
    still = {f"GPIO{pin}" for pin in range(LAST_PIN + 1)} - {topic.where for topic in seen.of(Kind.EDGE)}
    unit = tree["unit"][UNIT]
    unit["pins"] = {wire: pin for wire, pin in unit["pins"].items() if wire not in still}
    if not unit["pins"]:
        del unit["pins"]
    return [
        {**budget, "max": _above(verdict.worst)}
        for budget, verdict in zip(found, result.budgets, strict=True)
        if verdict.worst is not None and (verdict.count >= OFTEN - 1 or "period" not in budget["measure"])
    ]


def _above(value: float) -> str:
    """Return the limit for a measured time in us, as text: the time plus MARGIN %, rounded up to three digits."""
    limit = Fraction(value) * (100 + MARGIN) / 100
    step = Fraction(10) ** (math.floor(math.log10(limit)) - 2) if limit else Fraction(1)
    micros = math.ceil(limit / step) * step
    return f"{float(micros):.6g} us" if micros < 1000 else f"{float(micros / 1000):.6g} ms"
