"""The explanation of a worst occurrence as data: Steps in order of time, and Parts that add up to its length.

Window --explain--> Chain(steps, parts, more) --show--> text, --object--> JSON
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

from ....core.time import Timebase
from ....processor.instruction_location import parsed
from ....processor.source_location import SourceLocation
from ....timing.verdict import Verdict
from .cpu_activity import Doing, Stretch, phrase


@dataclass(frozen=True)
class FirmwarePlace:
    """A place in the firmware. file: None if known from a recording only. line: from 1; 0 for an image without lines.

    pc: of an instruction of an image.
    """

    function: str
    line: int
    file: Path | None
    pc: int | None = None

    def __str__(self) -> str:
        """ "imu_hil.py:106 (batch_read)", "imu_hil.asm:77 (_serve, 0x009051)"."""
        pc = [] if self.pc is None else [f"{self.pc:#08x}"]
        inside = [self.function] if self.file else []
        return f"{self.spot} ({', '.join([*inside, *pc])})" if inside or pc else self.spot

    @property
    def spot(self) -> str:
        """ "imu_hil.py:106"; with the function if the file is not known."""
        name = self.file.name if self.file else self.function
        return f"{name}:{self.line}" if self.line else name


def place_of(where: str) -> FirmwarePlace | None:
    """Return the place that a record's text names; None if it names none."""
    of_image = parsed(where)
    if of_image is not None:
        path = where.path if isinstance(where, SourceLocation) else of_image.file
        return FirmwarePlace(of_image.function, of_image.line, Path(path) if path else None, of_image.pc)
    function, _, line = where.rpartition(":")
    if not function or not line.isdecimal():
        return None
    return FirmwarePlace(function, int(line), Path(where.path) if isinstance(where, SourceLocation) else None)


@dataclass(frozen=True)
class Step:
    """One link of the chain. at: ticks from the begin of the occurrence. length: ticks; None for an instant."""

    at: int
    what: str
    length: int | None = None
    place: FirmwarePlace | None = None


@dataclass(frozen=True)
class Part:
    """A part of the occurrence's time, by activity. count: number of stretches. place: of the longest."""

    doing: Doing
    what: str
    length: int
    count: int = 1
    place: FirmwarePlace | None = None

    def __str__(self) -> str:
        return phrase(self.doing, self.what)


@dataclass(frozen=True)
class Chain:
    """steps: in order of time. parts: the longest first; if there are any, their lengths add up to `length`.

    length: of the occurrence, ticks. typical: the length of the least critical occurrence, None if unknown.
    typical_holds: that occurrence keeps the limit, so the difference to it explains why this one does not.
    more: difference of each part's length from that occurrence (ticks, signed), the largest first.
    """

    verdict: Verdict
    timebase: Timebase = field(compare=False)
    length: int
    steps: tuple[Step, ...]
    parts: tuple[Part, ...] = ()
    typical: int | None = None
    typical_holds: bool = True
    more: tuple[Part, ...] = ()
    blame: Part | None = None  # for an occurrence without length: its cause, an activity, access or note

    @property
    def blamed(self) -> Part | None:
        """The part with a place in the firmware that explains the length best.

        If the typical occurrence keeps the limit, it is the part that differs most from it, in the direction in which
        this one exceeds the limit; else the longest part.
        """
        if self.blame is not None:
            return self.blame
        candidates: Sequence[Part] = ()
        if self.typical_holds:
            sign = -1 if self.verdict.too_little else 1
            candidates = sorted((p for p in self.more if sign * p.length > 0), key=lambda part: -sign * part.length)
        return next((part for part in candidates or self.parts if part.place is not None), None)

    def us(self, ticks: int) -> Fraction:
        return Fraction(ticks * 1_000_000, self.timebase.per_second)


def parts_of(stretches: Iterable[Stretch]) -> tuple[Part, ...]:
    """Sum stretches by activity, the longest sum first."""
    sums: dict[tuple[Doing, str], list[Stretch]] = {}
    for one in stretches:
        sums.setdefault((one.doing, one.what), []).append(one)
    parts = []
    for (doing, what), of in sums.items():
        longest = max(of, key=lambda one: one.length)
        begun = len({one.since for one in of})
        parts.append(Part(doing, what, sum(one.length for one in of), begun, place_of(longest.where)))
    return tuple(sorted(parts, key=lambda part: -part.length))


def difference(here: Iterable[Part], there: Iterable[Part]) -> tuple[Part, ...]:
    """Return by how much each part is longer here, the largest first, without parts of equal length."""
    before = {(part.doing, part.what): part for part in there}
    found = []
    for part in here:
        other = before.pop((part.doing, part.what), None)
        found.append(Part(part.doing, part.what, part.length - (other.length if other else 0), part.count, part.place))
    found += [Part(p.doing, p.what, -p.length, p.count, p.place) for p in before.values()]
    return tuple(sorted((p for p in found if p.length), key=lambda part: -part.length))
