"""The profile of a run of images: as text, as JSON, as a flame graph for speedscope, and as line coverage (lcov).

    address --line--> DA: execution count         BRDA: not taken, taken counts
    function -------> FN, FNDA: execution count of its first instruction

The execution count of a line is the highest count of its instructions. Sources: speedscope's file-format-schema.json
(sampled profiles); geninfo(1), "TRACEFILE FORMAT".
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction

from msgspec import Struct

from ...core.text_table import paragraph, text_table
from ...processor.c28x.decoder import Instruction, sweep
from ...processor.image.observers import Coverage, Profile
from ...processor.image.program import ImageProgram
from ...processor.image_files.debug_info import FunctionMap
from ...processor.image_files.model import Image
from ...processor.source_location import parsed
from ...scene.case.model import Case
from ...scene.scene import Scene

LONGEST_TEXT = 20  # number of functions that are shown without -v
FINE = 1000  # in us; times below this value are shown with three decimals


class Profiled(Struct, frozen=True):
    """The profiles of a run.

    name: the name of the case.
    programs, profiles: dictionaries from units with an image to their programs and profiles.
    coverage: a dictionary from units with an image to their coverage; empty if no coverage was requested.
    """

    name: str
    ticks_per_second: int
    programs: dict[str, ImageProgram]
    profiles: dict[str, Profile]
    coverage: dict[str, Coverage]


def text(run: Profiled, every: bool = False) -> str:
    """Format a table of 80 columns for each unit. every: True to show all called functions, not only LONGEST_TEXT."""
    lines: list[str] = []
    for unit, profile in run.profiles.items():
        found = profile.functions()
        whole = sum(one.own for one in found) or 1
        shown = found if every else found[:LONGEST_TEXT]
        per_us = run.ticks_per_second / 1_000_000
        rows = [
            (
                one.name,
                _us(one.own / per_us),
                f"{100 * one.own / whole:.1f}",
                _us(one.total / per_us),
                _us(one.waits / per_us),
                str(one.calls),
                _begins_at(run.programs[unit].place_of(one.name)),
            )
            for one in shown
        ]
        lines += [f"{unit}: {whole / per_us:.3f} us in {len(found)} functions", ""]
        head = ("function", "self us", "%", "total", "waits", "calls", "begins at")
        lines += text_table(head, rows, right=(1, 2, 3, 4, 5), names=(0,))
        if len(found) > len(shown):
            lines.append(f"and {len(found) - len(shown)} with less; -v lists all")
        lines.append("")
    note = "self: in its own code, with waits; total: with called functions and interrupts"
    return "\n".join([*lines, *paragraph(note), *paragraph("waits: in IDLE, or in skipped polls")])


def _us(time: float) -> str:
    """Format a time in us with about six digits."""
    return f"{time:.3f}" if time < FINE else f"{time:.1f}"


def _begins_at(place: str) -> str:
    """Return the file and the line of a place; its address if these are unknown, or "" if the place is unknown."""
    at = parsed(place)
    return "" if at is None else f"{at.file}:{at.line}" if at.file else f"{at.pc:#08x}"


def _json_place(place: str) -> dict[str, object]:
    at = parsed(place)
    if at is None:
        return {}
    line = {"file": getattr(place, "path", at.file), "line": at.line} if at.file else {}
    return line | {"pc": f"{at.pc:#08x}"}


def as_json(run: Profiled) -> dict[str, object]:
    """Return the profile as a dictionary with times in seconds."""
    per_second = run.ticks_per_second
    return {
        "units": {
            unit: [
                {
                    "function": one.name,
                    "calls": one.calls,
                    "self_s": one.own / per_second,
                    "total_s": one.total / per_second,
                    "waits_s": one.waits / per_second,
                }
                | _json_place(run.programs[unit].place_of(one.name))
                for one in profile.functions()
            ]
            for unit, profile in run.profiles.items()
        }
    }


SCHEMA = "https://www.speedscope.app/file-format-schema.json"


Frame = tuple[str, str, int]  # the function, its file ("" if unknown), and its line (0 if unknown)


def speedscope(run: Profiled) -> dict[str, object]:
    """Return the flame graph as JSON. It has the call stacks of each unit in alphabetical order, with their seconds."""
    frames: dict[Frame, int] = {}

    def number(unit: str, function: str) -> int:
        place = run.programs[unit].place_of(function)
        return frames.setdefault((function, getattr(place, "path", ""), getattr(place, "line", 0)), len(frames))

    made: list[dict[str, object]] = []
    for unit, profile in run.profiles.items():
        stacks = sorted(stack for stack in profile.stacks if stack)
        weights = [profile.stacks[stack] / run.ticks_per_second for stack in stacks]
        made.append(
            {
                "type": "sampled",
                "name": unit,
                "unit": "seconds",
                "startValue": 0,
                "endValue": sum(weights),
                "samples": [[number(unit, function) for function in stack] for stack in stacks],
                "weights": weights,
            }
        )
    return {
        "$schema": SCHEMA,
        "name": run.name,
        "exporter": "periph-sim",
        "activeProfileIndex": 0,
        "shared": {
            "frames": [
                {"name": function} | ({"file": file, "line": line} if file else {}) for function, file, line in frames
            ]
        },
        "profiles": made,
    }


@dataclass
class FileCoverage:
    """The coverage of one source file.

    lines: a dictionary from line numbers to execution counts.
    branches: a dictionary from (line, address, way) to a count. For way 0, it is the number of times that the branch at
        the address was not taken; for way 1, the number of times that it was taken.
    functions: a dictionary from (line, name) to the execution count of the function with this name.
    """

    lines: Counter[int] = field(default_factory=Counter)
    branches: Counter[tuple[int, int, int]] = field(default_factory=Counter)
    functions: Counter[tuple[int, str]] = field(default_factory=Counter)


def covered_files(run: Profiled) -> dict[str, FileCoverage]:
    """Return a dictionary from source files to coverage, for all lines with code. Counts of several units are added."""
    found: dict[str, FileCoverage] = defaultdict(FileCoverage)
    for unit, program in run.programs.items():
        for file, of_file in _files(program.image, program.functions, run.coverage[unit]).items():
            found[file].lines.update(of_file.lines)
            found[file].branches.update(of_file.branches)
            found[file].functions.update(of_file.functions)
    return dict(sorted(found.items()))


def _files(image: Image, functions: FunctionMap, counts: Coverage) -> dict[str, FileCoverage]:
    found: dict[str, FileCoverage] = defaultdict(FileCoverage)
    for instruction in (one for section in image.code for one in sweep(section.run, section.words)):
        if not isinstance(instruction, Instruction):
            continue
        at = instruction.address
        place = functions.debug.line_at(at)
        if place is None:
            continue
        of_file = found[place.file]
        count, jumped = counts.executed_at[at], counts.jumped_at[at]
        of_file.lines[place.line] = max(of_file.lines[place.line], count)
        if instruction.target is not None and instruction.goes_on and not instruction.is_call:  # a conditional branch
            of_file.branches.update({(place.line, at, 0): count - jumped, (place.line, at, 1): jumped})
        inside = functions.at(at)
        if inside is not None and inside.address == at:
            of_file.functions[place.line, inside.name] = count
    return found


def tracefile(files: dict[str, FileCoverage], name: str) -> str:
    """Return the text of an lcov tracefile. name: the name of the test in the tracefile."""
    return "".join(f"{line}\n" for file, of_file in files.items() for line in _record(file, of_file, name))


def _record(file: str, of_file: FileCoverage, name: str) -> Iterator[str]:
    yield f"TN:{name}"
    yield f"SF:{file}"
    functions = sorted(of_file.functions.items())
    yield from (f"FN:{line},{function}" for (line, function), _ in functions)
    yield from (f"FNDA:{count},{function}" for (_, function), count in functions)
    yield f"FNF:{len(functions)}"
    yield f"FNH:{sum(count > 0 for _, count in functions)}"
    for (line, address, way), count in sorted(of_file.branches.items()):
        executed = count or of_file.branches[line, address, 1 - way]
        yield f"BRDA:{line},{address},{way},{count if executed else '-'}"
    yield f"BRF:{len(of_file.branches)}"
    yield f"BRH:{sum(count > 0 for count in of_file.branches.values())}"
    yield from (f"DA:{line},{count}" for line, count in sorted(of_file.lines.items()))
    yield f"LF:{len(of_file.lines)}"
    yield f"LH:{sum(count > 0 for count in of_file.lines.values())}"
    yield "end_of_record"


def profiled(
    case: Case,
    length: Fraction | None = None,
    on_progress: Callable[[float], None] | None = None,
    coverage: bool = False,
) -> Profiled:
    """Run a case and return the profiles of its images.

    length: the duration of the run in seconds; None for the duration that the case states.
    on_progress: a function that is called with the completed share, 0 to 1.
    coverage: True to count the executions of each instruction, too.

    Raise BadCase if no unit runs an image, or if an image lacks the line information that coverage needs.
    """
    scene = Scene(case)
    programs = {name: unit.program for name, unit in scene.units.items() if isinstance(unit.program, ImageProgram)}
    if not programs:
        raise case.mistake("no unit runs an image, and a profile is of images; give a unit image = ...", "unit")
    found = Profiled(case.name, scene.timebase.per_second, programs, {}, {})
    for name, program in programs.items():
        if coverage and not program.functions.debug.lines:
            what = "it tells no lines of its source, so there is nothing to cover; compile it with -g"
            raise case.mistake(what, "unit", name, "image")
        found.profiles[name] = Profile()
        program.add_call_listener(found.profiles[name])
        if coverage:
            found.coverage[name] = Coverage()
            program.watch_instructions(found.coverage[name])
    scene.run(length, on_progress)
    for name, profile in found.profiles.items():
        since = programs[name].asleep_since
        if since is not None:
            profile.slept(scene.kernel.now - since)
        profile.count_to(scene.kernel.now)
    return found
