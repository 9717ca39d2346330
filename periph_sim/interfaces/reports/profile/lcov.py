"""Line coverage of an image's sources as an lcov tracefile for genhtml.

    address --line--> DA: execution count         BRDA: not taken, taken counts
    function -------> FN, FNDA: execution count of its first instruction

The count of a line is the highest count of its instructions. Source: geninfo(1), "TRACEFILE FORMAT".
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator

from ....processor.c28x.decoder import Instruction, sweep
from ....processor.image.observers import Coverage
from ....processor.image_files.debug_info import FunctionMap
from ....processor.image_files.load import Image


class FileCoverage:
    """The coverage of one source file.

    lines: the count of each line.
    branches: for each (line, address), how often the branch was not taken and taken.
    functions: the line and the count of each function.
    """

    def __init__(self) -> None:
        self.lines: dict[int, int] = {}
        self.branches: dict[tuple[int, int], tuple[int, int]] = {}
        self.functions: dict[str, tuple[int, int]] = {}

    def add(self, other: FileCoverage) -> None:
        """Add the counts of another unit for the same file."""
        for line, count in other.lines.items():
            self.lines[line] = self.lines.get(line, 0) + count
        for branch, (on, jumped) in other.branches.items():
            before_on, before_jumped = self.branches.get(branch, (0, 0))
            self.branches[branch] = (before_on + on, before_jumped + jumped)
        for name, (line, count) in other.functions.items():
            self.functions[name] = (line, self.functions.get(name, (0, 0))[1] + count)


Covered = tuple[Image, FunctionMap, Coverage]


def covered_files(programs: Iterable[Covered]) -> dict[str, FileCoverage]:
    """Return the coverage of each source file, for all lines with code. Counts of several units are added."""
    found: dict[str, FileCoverage] = defaultdict(FileCoverage)
    for image, functions, counts in programs:
        for file, of_file in _files(image, functions, counts).items():
            found[file].add(of_file)
    return dict(sorted(found.items()))


def _files(image: Image, functions: FunctionMap, counts: Coverage) -> dict[str, FileCoverage]:
    found: dict[str, FileCoverage] = defaultdict(FileCoverage)
    for instruction in _instructions(image):
        at = instruction.address
        place = functions.debug.line_at(at)
        if place is None:
            continue
        of_file = found[place.file]
        count, jumped = counts.executed_at[at], counts.jumped_at[at]
        of_file.lines[place.line] = max(of_file.lines.get(place.line, 0), count)
        if instruction.target is not None and instruction.goes_on and not instruction.is_call:  # a conditional branch
            of_file.branches[place.line, at] = (count - jumped, jumped)
        inside = functions.at(at)
        if inside is not None and inside.address == at:
            of_file.functions[inside.name] = (place.line, count)
    return found


def _instructions(image: Image) -> Iterator[Instruction]:
    for section in image.code:
        for found in sweep(section.run, section.words):
            if isinstance(found, Instruction):
                yield found


def tracefile(files: dict[str, FileCoverage], name: str) -> str:
    """Return the tracefile's text. name: the name of the test."""
    return "".join(f"{line}\n" for file, of_file in files.items() for line in _record(file, of_file, name))


def _record(file: str, of_file: FileCoverage, name: str) -> Iterator[str]:
    yield f"TN:{name}"
    yield f"SF:{file}"
    functions = sorted(of_file.functions.items(), key=lambda item: item[1])
    yield from (f"FN:{line},{function}" for function, (line, _) in functions)
    yield from (f"FNDA:{count},{function}" for function, (_, count) in functions)
    yield f"FNF:{len(functions)}"
    yield f"FNH:{sum(count > 0 for _, (_, count) in functions)}"
    ways = 0
    for (line, address), counts in sorted(of_file.branches.items()):
        for way, count in enumerate(counts):
            ways += count > 0
            yield f"BRDA:{line},{address},{way},{count if any(counts) else '-'}"
    yield f"BRF:{2 * len(of_file.branches)}"
    yield f"BRH:{ways}"
    yield from (f"DA:{line},{count}" for line, count in sorted(of_file.lines.items()))
    yield f"LF:{len(of_file.lines)}"
    yield f"LH:{sum(count > 0 for count in of_file.lines.values())}"
    yield "end_of_record"
