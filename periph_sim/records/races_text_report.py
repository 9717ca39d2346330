"""The races of a run, and the flags that read-modify-writes lost, as text and as JSON."""

from __future__ import annotations

import dataclasses

from ..core.phrases import counted
from ..core.text_table import paragraph, text_table
from ..processor.source_location import parsed
from .races import DECADES, PlaceRaces, Races
from .read_modify_write import ReadModifyWrite

CLOSEST = ("register", "place", "closest", "cycles", "field", "at")
COUNTS = ("register", "place", "reads", "polls", *("0", "<10", "<100", "<1k", "<10k", "more"))
NOTES = (
    "reads: recorded reads. polls: reads beside a change in skipped waits, reconstructed from the length of a pass. "
    "Columns 0 to more: reads and polls by the number of cycles to the nearest change.",
    "A read that names a field is compared with the changes of that field. A read of the whole register, such as the "
    "read of a read-modify-write, is compared with the changes of all fields. Changes that an access of the firmware "
    "makes at once do not count.",
)


def text(races: Races) -> str:
    """Return the report: tables of the places that read registers, flags lost by read-modify-writes, and notes.

    The places are in the order of `Races.places`: the first one has the read that was closest to a change.
    """
    run = races.run
    if not races.places:
        return f"{run.name}: no read of a status register was recorded"
    lines = [*paragraph(f"{run.name}: cycles between reads and changes; {run.cycles.how}"), ""]
    closest_rows = [row for place in races.places for row in _closest(races, place)]
    lines += [*text_table(CLOSEST, closest_rows, (3, 5)), ""]
    lines += [*text_table(COUNTS, [_counts(races, place) for place in races.places], range(2, len(COUNTS))), ""]
    if races.modifies:
        lines.append("read-modify-writes of flags that writing 1 clears:")
        modifies = [line for modify in races.modifies for line in _modify(races, modify)]
        lines += [part for line in modifies for part in paragraph(line.lstrip(), _indent(line), f"{_indent(line)}  ")]
        lines.append("")
    unplaced = sum(place.unplaced for place in races.places)
    lines += [line for note in NOTES for line in paragraph(f"note: {note}")]
    if unplaced:
        lines += paragraph(
            f"note: {unplaced} skipped waits with a change in them do not show how long a pass is; "
            "there only the recorded reads count"
        )
    closest = "no change to be near to" if races.closest is None else f"{races.closest} cycles"
    lines.append(f"closest: {closest}; flags lost to read-modify-writes: {races.lost} (cleared along: {races.along})")
    return "\n".join(lines)


def as_json(races: Races) -> dict[str, object]:
    """Return the races for JSON, with distances in cycles.

    Times are in seconds, except those in the lists `lost` and `cleared` of each flag, which are in ticks.
    """
    run = races.run
    return {
        "run": run.name,
        "cycle_ticks": float(run.cycles.ticks),
        "cycle_from": run.cycles.how,
        "closest": races.closest,
        "lost": races.lost,
        "cleared_along": races.along,
        "decades": ["0", *(f"{10**n}..{10 ** (n + 1) - 1}" for n in range(DECADES - 2)), f"{10 ** (DECADES - 2)}.."],
        "places": [
            {
                **dataclasses.asdict(place),
                **{
                    side: None
                    if miss is None
                    else {"cycles": miss.cycles, "read_at_s": float(run.seconds(miss.tick)), "field": miss.field}
                    for side, miss in (("before", place.before), ("after", place.after))
                },
            }
            for place in races.places
        ],
        "modifies": [
            {
                **dataclasses.asdict(modify),
                "lost": modify.lost,
                "flags": [
                    {
                        **dataclasses.asdict(flag),
                        "first_s": None if flag.first is None else float(run.seconds(flag.first)),
                    }
                    for flag in modify.flags
                ],
            }
            for modify in races.modifies
        ],
        "notes": list(NOTES),
    }


def _closest(races: Races, place: PlaceRaces) -> list[tuple[str, ...]]:
    """Return two rows: one for the closest read before a change, one for the closest read after a change.

    Only the first row has the names of the register and of the place in the firmware.
    """
    found = [("before", place.before), ("after", place.after)]
    rows = [
        (side, *(("-", "", "") if miss is None else (str(miss.cycles), miss.field, races.run.at(miss.tick))))
        for side, miss in found
    ]
    return [(_name(races, place), place.place, *rows[0]), ("", "", *rows[1])]


def _counts(races: Races, place: PlaceRaces) -> tuple[str, ...]:
    # In a program image, the place has a function, a source line and an address. This table shows it without the source
    # line, which is in the first table. For other firmware, or if the function is unknown, `at` is None.
    at = parsed(place.place)
    short = place.place if at is None else f"{at.function} {at.pc:#08x}"
    return (_name(races, place), short, str(place.reads), str(place.polls), *map(str, place.histogram))


def _indent(line: str) -> str:
    return line[: len(line) - len(line.lstrip())]


def _name(races: Races, of: PlaceRaces | ReadModifyWrite) -> str:
    return of.register if len(races.run.units) == 1 else f"{of.unit}.{of.register}"


def _modify(races: Races, modify: ReadModifyWrite) -> list[str]:
    meant = " and ".join(modify.meant)
    if modify.doubt:
        meant = f"one of {', '.join(modify.doubt)}, all set each time"
    lines = [
        f"  {_name(races, modify)} at {modify.place}: {counted(modify.count, 'time')}, to clear {meant or 'nothing'}"
    ]
    for flag in modify.flags:
        if flag.rose:
            lines.append(
                f"    {flag.flag} rose between read and write {counted(flag.rose, 'time')}; lost {flag.lost_between}"
            )
        if flag.along:
            lines.append(
                f"    {flag.flag} was cleared along with it {counted(flag.along, 'time')}, {flag.unseen} of them never "
                f"read since it rose; first at {races.run.at(flag.first or 0)}"
            )
    return lines if modify.flags else [f"{lines[0]}; no other flag cleared, none rose in between"]
