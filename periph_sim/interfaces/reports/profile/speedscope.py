"""A profile as a flame graph file for speedscope and Perfetto.

Source: speedscope's file-format-schema.json (sampled profiles).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ....processor.image.profile import Profile

SCHEMA = "https://www.speedscope.app/file-format-schema.json"


Frame = tuple[str, str, int]  # function, file, line; "" and 0 if unknown


def speedscope(
    profiles: Mapping[str, Profile], ticks_per_second: int, name: str, place_of: Callable[[str, str], str]
) -> dict[str, object]:
    """Return the file's JSON: each unit's stacks in alphabetical order, weighted with their seconds.

    place_of: returns the location of the first instruction of a unit's function.
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
