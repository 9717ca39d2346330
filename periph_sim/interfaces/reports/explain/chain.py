"""The explanation of a worst occurrence: Steps in order of time, and Parts into which its time is divided.

Window --explain--> Chain(steps, parts, more) --text--> lines; --as_json--> plain data with times in microseconds

    stretch 97.953 us, at most 50.000 us allowed, at 0.105195 s
        -190.000 us              repeated START, gyroscope (0x68 R)
        -102.680 us  200.387 us  SCIRXINTA entered, preempting the wait for ... [imu_hil.py:60 (sci_received)]
      made up of
        97.560 us  99.6 %  span frame [imu_hil.py:66 (sci_received)]
      +97.953 us against 0.000 us, its least critical occurrence
        +97.560 us  span frame
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ....core.text_table import columns, together
from ....core.time import Timebase
from ....processor.source_location import SourceLocation, parsed
from ....timing.verdict import Verdict, assumes_lines, figure, in_words, instant, percentile
from .cpu_activity import Doing, Stretch, phrase


@dataclass(frozen=True)
class FirmwarePlace:
    """A place in the firmware.

    file: the path of the file; None if the place is known only from a recording.
    line: the number of the line, from 1; 0 for an image without line numbers.
    pc: the address of the instruction in an image; None for other firmware.
    """

    function: str
    line: int
    file: Path | None
    pc: int | None = None

    def __str__(self) -> str:
        """Format the place: "imu_hil.py:106 (batch_read)", "imu_hil.asm:77 (_serve, 0x009051)"."""
        pc = [] if self.pc is None else [f"{self.pc:#08x}"]
        inside = [self.function] if self.file else []
        return f"{self.spot} ({', '.join([*inside, *pc])})" if inside or pc else self.spot

    @property
    def spot(self) -> str:
        """The file and the line, "imu_hil.py:106"; the function and the line if the file is unknown."""
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
    """One event of an explanation.

    at: the time of the event, in ticks from the verdict's instant (see `Window.at`).
    length: the duration of the event in ticks; None for an instant.
    """

    at: int
    what: str
    length: int | None = None
    place: FirmwarePlace | None = None


@dataclass(frozen=True)
class Part:
    """The part of an occurrence's time that one activity takes.

    length: the total time of the activity in ticks.
    count: the number of times that the activity began.
    place: the place in the firmware of the longest stretch of the activity; None if unknown.
    """

    doing: Doing
    what: str
    length: int
    count: int = 1
    place: FirmwarePlace | None = None

    def __str__(self) -> str:
        return phrase(self.doing, self.what)


@dataclass(frozen=True)
class Chain:
    """The explanation of an occurrence. Lengths are in ticks.

    length: the length of the occurrence.
    steps: the events, in order of time.
    parts: the parts of the time, the longest first. If there are any, their lengths add up to `length`.
    typical: the length of the least critical occurrence; None if unknown.
    typical_holds: True if the least critical occurrence keeps the limit. In this case, the difference from it explains
        why the occurrence exceeds the limit.
    more: the parts whose lengths differ from those in the least critical occurrence, with the difference as `length`;
        the largest difference first.
    assumed: the options that decided undocumented behaviours in the occurrence or shortly before it, if a limit is
        broken; otherwise empty.
    blame: the cause, if it follows directly from a record: an activity of the firmware, an access, or the note of a
        device on a broken rule. None if it does not.
    """

    verdict: Verdict
    timebase: Timebase = field(compare=False)
    length: int
    steps: tuple[Step, ...]
    parts: tuple[Part, ...] = ()
    typical: int | None = None
    typical_holds: bool = True
    more: tuple[Part, ...] = ()
    assumed: tuple[str, ...] = ()
    blame: Part | None = None

    @property
    def blamed(self) -> Part | None:
        """The cause of the occurrence: `blame`, or the part with a place in the firmware that explains the length best.

        If the least critical occurrence keeps the limit, this is the part whose length differs most between the two
        occurrences, in the direction in which the limit is exceeded. Otherwise, or without such a difference, it is the
        longest part. None if these parts have no place.
        """
        if self.blame is not None:
            return self.blame
        candidates: Sequence[Part] = ()
        if self.typical_holds:
            sign = -1 if self.verdict.too_little else 1
            candidates = sorted((p for p in self.more if sign * p.length > 0), key=lambda part: -sign * part.length)
        return next((part for part in candidates or self.parts if part.place is not None), None)

    def us(self, ticks: int) -> float:
        return ticks * 1_000_000 / self.timebase.per_second

    def figure(self, ticks: int) -> str:
        """Format a length in the same way as `timing.verdict.figure`."""
        return figure(self.us(ticks), "us")


def parts_of(stretches: Iterable[Stretch]) -> tuple[Part, ...]:
    """Return the total time of each activity as a part, the longest first."""
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
    """Return each part of `here` and `there` with its length in `here` minus that in `there`, the largest one first.

    A part that is missing has the length 0. Parts of equal length are left out.
    """
    before = {(part.doing, part.what): part for part in there}
    found = []
    for part in here:
        other = before.pop((part.doing, part.what), None)
        found.append(Part(part.doing, part.what, part.length - (other.length if other else 0), part.count, part.place))
    found += [Part(p.doing, p.what, -p.length, p.count, p.place) for p in before.values()]
    return tuple(sorted((p for p in found if p.length), key=lambda part: -part.length))


MOST_PARTS = 6


def text(chain: Chain) -> list[str]:
    """Return the explanation as lines. The first line has the budget, and its worst value or what was found."""
    show = chain.timebase.show

    def signed(ticks: int) -> str:
        return f"{'+' * (ticks > 0)}{show(ticks)}"

    rows = [
        (show(step.at), "" if step.length is None else show(step.length), f"{step.what}{_bracketed(step.place)}")
        for step in chain.steps
    ]
    lines = [_head(chain.verdict), *_table(rows)]
    if chain.parts:
        rows = [
            (
                show(part.length),
                f"{100 * part.length / chain.length:.1f} %",
                f"{part}{f', {part.count} times' if part.count > 1 else ''}{_bracketed(part.place)}",
            )
            for part in largest(chain.parts)
        ]
        lines += ["  made up of", *_table(rows)]
    if chain.more:
        typical = chain.typical or 0
        rows = [(signed(part.length), "", str(part)) for part in largest(chain.more)]
        more = signed(chain.length - typical)
        lines += [f"  {more} against {show(typical)}, its least critical occurrence", *_table(rows)]
    return [*lines, *assumes_lines(chain.assumed)]


def _head(verdict: Verdict) -> str:
    kept = verdict.margin is not None and verdict.margin >= 0
    if verdict.worst is None or (verdict.broken and kept):
        return f"{verdict.name}: {verdict.found or 'nothing was measured'}"
    worst, limit = (in_words(value, verdict.unit) for value in (verdict.worst, verdict.limit))
    return f"{verdict.name} {worst}, {bound(verdict.which)} {limit} allowed, at {instant(verdict.at_s)}"


def bound(which: str) -> str:
    """Return the words for the key of a limit: "at most", "p99 at most"."""
    words = {"max": "at most", "min": "at least", "exactly": "exactly"}
    return words.get(which) or f"{percentile(which)} at most"


def largest(parts: tuple[Part, ...]) -> tuple[Part, ...]:
    """Return the parts that are shown, which are the MOST_PARTS parts with the largest absolute lengths."""
    return tuple(sorted(parts, key=lambda part: -abs(part.length))[:MOST_PARTS])


def _bracketed(place: FirmwarePlace | None) -> str:
    """Format a place in brackets after a blank, without spaces at which a line could be broken."""
    return "" if place is None else f" {together(f'[{place}]')}"


def _table(rows: list[tuple[str, str, str]]) -> list[str]:
    return columns(rows, right=(0, 1), indent="    ")


def as_json(chain: Chain) -> dict[str, object]:
    """Convert to JSON, with times in us.

    A step has the keys at_us (counted from the verdict's instant), what and, if it has a duration, length_us. A part
    has the keys what, length_us and count. Steps and parts with a place also have the keys function and line and, if
    known, file and pc.
    """
    return {
        "steps": [
            {"at_us": round(chain.us(step.at), 4), "what": step.what}
            | ({} if step.length is None else {"length_us": round(chain.us(step.length), 4)})
            | _json_place(step.place)
            for step in chain.steps
        ],
        "parts": [_json_part(chain, part) for part in chain.parts],
        "length_us": round(chain.us(chain.length), 4),
        "typical_us": None if chain.typical is None else round(chain.us(chain.typical), 4),
        "more": [_json_part(chain, part) for part in chain.more],
        "assumes": list(chain.assumed),
    }


def _json_part(chain: Chain, part: Part) -> dict[str, object]:
    row = {"what": str(part), "length_us": round(chain.us(part.length), 4), "count": part.count}
    return row | _json_place(part.place)


def _json_place(place: FirmwarePlace | None) -> dict[str, object]:
    if place is None:
        return {}
    file = {} if place.file is None else {"file": relative(place.file).as_posix()}
    pc = {} if place.pc is None else {"pc": f"{place.pc:#08x}"}
    return {"function": place.function, "line": place.line} | file | pc


def relative(file: Path) -> Path:
    """Return the path relative to the current directory if the file is below this directory; else the path itself."""
    return file.relative_to(Path.cwd()) if file.is_relative_to(Path.cwd()) else file


def in_order(*steps: Iterable[Step]) -> tuple[Step, ...]:
    """Return the steps of several sources in order of time, each once.

    If the text of one step is the beginning of the texts of other steps with the same place, tick and length, only the
    step with the longest text is kept.
    """
    together: list[Step] = []
    for step in (step for some in steps for step in some):
        there = (one for one in together if (one.at, one.length, one.place) == (step.at, step.length, step.place))
        same = next((o for o in there if o.what.startswith(step.what) or step.what.startswith(o.what)), None)
        if same is None:
            together.append(step)
        elif len(step.what) > len(same.what):
            together[together.index(same)] = step
    return tuple(sorted(together, key=lambda step: step.at))
