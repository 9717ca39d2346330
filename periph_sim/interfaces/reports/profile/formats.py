"""A profile as text, as JSON, and as a flame graph file for speedscope or Perfetto.

Source: speedscope's file-format-schema.json (sampled profiles).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ....core.text_table import paragraph, text_table
from ....processor.image.observers import Profile
from ....processor.source_location import parsed

LONGEST_TEXT = 20  # number of functions that are shown without -v
FINE = 1000  # in us; shorter times are shown with three decimals
PlaceOf = Callable[[str, str], str]  # returns the location of the first instruction of a unit's function


def text(profiles: Mapping[str, Profile], ticks_per_second: int, place_of: PlaceOf, every: bool = False) -> str:
    """Format a table of 80 columns for each unit. every: True to show all functions that were called."""
    lines: list[str] = []
    for unit, profile in profiles.items():
        found = profile.functions()
        whole = sum(one.own for one in found) or 1
        shown = found if every else found[:LONGEST_TEXT]
        per_us = ticks_per_second / 1_000_000
        rows = [
            (
                one.name,
                _us(one.own / per_us),
                f"{100 * one.own / whole:.1f}",
                _us(one.total / per_us),
                _us(one.waits / per_us),
                str(one.calls),
                _begins_at(place_of(unit, one.name)),
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
    """Return the file and line of a place, or its address if they are unknown."""
    at = parsed(place)
    return "" if at is None else f"{at.file}:{at.line}" if at.file else f"{at.pc:#08x}"


def _json_place(place: str) -> dict[str, object]:
    at = parsed(place)
    if at is None:
        return {}
    line = {"file": getattr(place, "path", at.file), "line": at.line} if at.file else {}
    return line | {"pc": f"{at.pc:#08x}"}


def as_json(profiles: Mapping[str, Profile], ticks_per_second: int, place_of: PlaceOf) -> dict[str, object]:
    """Return the profile as a dictionary with times in seconds."""
    return {
        "units": {
            unit: [
                {
                    "function": one.name,
                    "calls": one.calls,
                    "self_s": one.own / ticks_per_second,
                    "total_s": one.total / ticks_per_second,
                    "waits_s": one.waits / ticks_per_second,
                }
                | _json_place(place_of(unit, one.name))
                for one in profile.functions()
            ]
            for unit, profile in profiles.items()
        }
    }


SCHEMA = "https://www.speedscope.app/file-format-schema.json"


Frame = tuple[str, str, int]  # function, file and line, which are "" and 0 if unknown


def speedscope(
    profiles: Mapping[str, Profile], ticks_per_second: int, name: str, place_of: Callable[[str, str], str]
) -> dict[str, object]:
    """Return the flame graph as JSON: the stacks of each unit in alphabetical order, weighted with their seconds.

    place_of: a function that returns the location of the first instruction of a unit's function.
    """
    frames: dict[Frame, int] = {}

    def number(unit: str, function: str) -> int:
        place = place_of(unit, function)
        frame = function, getattr(place, "path", ""), getattr(place, "line", 0)
        return frames.setdefault(frame, len(frames))

    made: list[dict[str, object]] = []
    for unit, profile in profiles.items():
        stacks = sorted(stack for stack in profile.stacks if stack)
        weights = [profile.stacks[stack] / ticks_per_second for stack in stacks]
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
        "name": name,
        "exporter": "periph-sim",
        "activeProfileIndex": 0,
        "shared": {
            "frames": [
                {"name": function} | ({"file": file, "line": line} if file else {}) for function, file, line in frames
            ]
        },
        "profiles": made,
    }
