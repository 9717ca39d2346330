"""Which mutants are tried: rooms and a seed go in, a sample of one-line changes comes out.

    room --> files --> lines that can be changed --seed--> lines in random order, one change of each --> Mutant

Lines are drawn, not changes: a line full of constants is one chance like any other.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass
from pathlib import Path
from random import Random

from .operators import Change, changes


@dataclass(frozen=True)
class Room:
    """sources: folders of the package. tests: folders of tests that are about them. also: others that run them.

    What passes the tests that run a line is tried with whole files of `tests`, the long ones too; of `also` no more.
    """

    sources: tuple[str, ...]
    tests: tuple[str, ...]
    also: tuple[str, ...] = ()


ROOMS = {
    "chips": Room(("periph_sim/f28335",), ("tests/f28335",)),
    "processor": Room(("periph_sim/processor",), ("tests/processor",), ("tests/scene",)),
    "measures": Room(("periph_sim/timing",), ("tests/timing",)),
    "decoders": Room(("periph_sim/traces/decode",), ("tests/traces/decode",)),
    "insight": Room(
        ("periph_sim/records", "periph_sim/explain"),
        ("tests/records", "tests/explain"),
        ("tests/commands/test_insight.py",),
    ),
    "numeric": Room(("periph_sim/sensors/numeric",), ("tests/sensors/numeric",)),
    "models": Room(("periph_sim/sensors/models",), ("tests/sensors/models",)),
    "c28x": Room(("periph_sim/c28x",), ("tests/c28x",), ("tests/image", "tests/processor/image")),
    "image": Room(("periph_sim/image",), ("tests/image",)),
    "extremes": Room(("periph_sim/sensors/extremes",), ("tests/sensors/extremes",)),
    "outside": Room(("periph_sim/outside",), ("tests/outside", "tests/scene/test_outside_parties.py")),
}
USUAL = ("chips", "processor", "measures", "decoders", "insight")


@dataclass(frozen=True)
class Mutant:
    """path: from the root. before, after: the line, without blanks around it. in_function: no import runs the line."""

    room: str
    path: str
    change: Change
    before: str
    after: str
    in_function: bool

    def __str__(self) -> str:
        return f"{self.path}:{self.change.line}: {self.before}  -->  {self.after}"


def files_of(room: str, root: Path) -> list[str]:
    """The sources of a room, from the root. SystemExit for a room that has none: its folder has moved."""
    found = sorted(
        str(path.relative_to(root)) for folder in ROOMS[room].sources for path in (root / folder).rglob("*.py")
    )
    if not found:
        raise SystemExit(f"room {room!r}: no sources in {', '.join(ROOMS[room].sources)}; see tests/mutants/sample.py")
    return found


def mutants_of(room: str, path: str, root: Path) -> list[list[Mutant]]:
    """Every mutant of a file, line by line."""
    source = (root / path).read_text(encoding="utf-8")
    lines = source.encode().splitlines(keepends=True)
    inside = _lines_of_functions(source)
    found: dict[int, list[Mutant]] = {}
    for change in changes(source):
        line = lines[change.line - 1]
        before, after = line.decode().strip(), change.applied(line).decode().strip()
        mutant = Mutant(room, path, change, before, after, change.line in inside)
        found.setdefault(change.line, []).append(mutant)
    return list(found.values())


def _lines_of_functions(source: str) -> set[int]:
    """Those of their bodies: not of their heads, whose defaults are computed on import."""
    functions = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.FunctionDef)]
    return {line for f in functions for line in range(f.body[0].lineno, (f.end_lineno or 0) + 1)}


def every(path: str, root: Path) -> list[Mutant]:
    """All mutants of one file. SystemExit for a file of no room."""
    room = next((name for name in ROOMS if path in files_of(name, root)), None)
    if room is None:
        raise SystemExit(f"{path}: a file of no room; rooms are {', '.join(ROOMS)}")
    return [mutant for line in mutants_of(room, path, root) for mutant in line]


def drawn(rooms: tuple[str, ...], count: int, seed: int, root: Path) -> list[Mutant]:
    """`count` mutants of these rooms, each of another line; fewer where there are not so many lines."""
    random = Random(seed)
    lines = [line for room in rooms for path in files_of(room, root) for line in mutants_of(room, path, root)]
    return [random.choice(line) for line in random.sample(lines, min(count, len(lines)))]
