"""Random sample of one-line mutants of the sources of rooms.

    room --> files --> lines that can be changed --seed--> lines in random order, one change of each --> Mutant

Lines are drawn, not changes, so that a line with many constants is as likely as any other.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from random import Random

from .operators import Change, changes


@dataclass(frozen=True)
class Room:
    """sources: folders of the package. tests: folders with their tests. also: folders with other tests that run them.

    A mutant that survives the tests that run its line is tested with each whole folder of `tests`, long tests included.
    Of `also`, only tests that run the line are used. without: files of the sources that are not sampled.
    """

    sources: tuple[str, ...]
    tests: tuple[str, ...]
    also: tuple[str, ...] = ()
    without: tuple[str, ...] = ()


ROOMS = {
    "chips": Room(("periph_sim/f28335",), ("tests/f28335",)),
    "processor": Room(("periph_sim/processor",), ("tests/processor",), ("tests/scene",)),
    "measures": Room(("periph_sim/timing",), ("tests/timing",)),
    "decoders": Room(("periph_sim/traces/decode",), ("tests/traces/decode",)),
    "insight": Room(
        ("periph_sim/records", "periph_sim/interfaces/reports/explain"),
        ("tests/records", "tests/interfaces/reports/explain"),
        ("tests/interfaces/commands/test_insight.py",),
    ),
    "numeric": Room(("periph_sim/imu/numeric",), ("tests/imu/numeric",)),
    "models": Room(("periph_sim/imu/models",), ("tests/imu/models",)),
    "c28x": Room(("periph_sim/processor/c28x",), ("tests/processor/c28x", "tests/processor/image")),
    "image": Room(("periph_sim/processor/image_files",), ("tests/processor/image_files",)),
    "extremes": Room(("periph_sim/imu/extremes",), ("tests/imu/extremes",)),
    "outside": Room(
        ("periph_sim/outside",),
        ("tests/outside", "tests/scene/test_outside_parties.py", "tests/interfaces/commands/test_terminal.py"),
    ),
    "scene": Room(
        ("periph_sim/scene",),
        (
            "tests/devices/targets",
            "tests/devices/watchers",
            "tests/timing/language/test_scope.py",
            "tests/timing/test_rounds.py",
            "tests/replay/test_session.py",
            "tests/scene",
        ),
    ),
    "proof": Room(
        ("periph_sim/proof",),
        (
            "tests/proof",
            "tests/interfaces/commands/test_prove.py",
            "tests/interfaces/commands/test_prove_questions.py",
            "tests/interfaces/commands/test_prove_table.py",
            "tests/interfaces/commands/test_saved_proof.py",
            "tests/interfaces/reports/test_coverage_check.py",
            "tests/interfaces/reports/test_witness.py",
        ),
    ),
    "replay": Room(("periph_sim/replay",), ("tests/replay",)),
    "records": Room(("periph_sim/records",), ("tests/records",)),
    "devices": Room(("periph_sim/devices",), ("tests/devices", "tests/scene/test_devices.py")),
    "baselines": Room(("periph_sim/interfaces/reports/baselines",), ("tests/interfaces/reports/baselines",)),
}
USUAL = ("chips", "processor", "measures", "decoders", "insight")


@dataclass(frozen=True)
class Mutant:
    """A changed line of a file. path: relative to the root. before, after: the line without surrounding blanks."""

    room: str
    path: str
    change: Change
    before: str
    after: str

    def __str__(self) -> str:
        return f"{self.path}:{self.change.line}: {self.before}  -->  {self.after}"


def files_of(room: str, root: Path) -> list[str]:
    """Return the source files of a room, relative to the root. Raise SystemExit if its folder does not exist."""
    sources, without = ROOMS[room].sources, ROOMS[room].without
    found = {str(path.relative_to(root)) for folder in sources for path in (root / folder).rglob("*.py")}
    if not found or not found >= {*without}:
        raise SystemExit(f"room {room!r}: {', '.join((*sources, *without))}: not there; see tests/mutants/sample.py")
    return sorted(found - {*without})


def mutants_of(room: str, path: str, root: Path) -> list[list[Mutant]]:
    """Return all mutants of a file, grouped by line."""
    source = (root / path).read_text(encoding="utf-8")
    lines = source.encode().splitlines(keepends=True)
    found: dict[int, list[Mutant]] = {}
    for change in changes(source):
        line = lines[change.line - 1]
        before, after = line.decode().strip(), change.applied(line).decode().strip()
        found.setdefault(change.line, []).append(Mutant(room, path, change, before, after))
    return list(found.values())


def every(path: str, root: Path) -> list[Mutant]:
    """Return all mutants of one file. Raise SystemExit for a file that is in no room."""
    room = next((name for name in ROOMS if path in files_of(name, root)), None)
    if room is None:
        raise SystemExit(f"{path}: a file of no room; rooms are {', '.join(ROOMS)}")
    return [mutant for line in mutants_of(room, path, root) for mutant in line]


def drawn(rooms: tuple[str, ...], count: int, seed: int, root: Path) -> list[Mutant]:
    """Return `count` mutants of these rooms, each of another line, or fewer if there are fewer lines."""
    random = Random(seed)
    lines = [line for room in rooms for path in files_of(room, root) for line in mutants_of(room, path, root)]
    return [random.choice(line) for line in random.sample(lines, min(count, len(lines)))]
