"""Profile of a run of images: time by function and counts by instruction, for each unit."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from msgspec import Struct

from ..processor.image.observers import Coverage, Profile
from ..processor.image.program import ImageProgram
from .case.model import Case
from .scene import Scene


class Profiled(Struct, frozen=True):
    """Dictionaries from a unit to its program, its profile and its coverage. `coverage` is empty if not requested."""

    name: str
    ticks_per_second: int
    programs: dict[str, ImageProgram]
    profiles: dict[str, Profile]
    coverage: dict[str, Coverage]

    def place_of(self, unit: str, function: str) -> str:
        """Return the source location at which a function of a unit's image begins."""
        return self.programs[unit].place_of(function)


def profiled(
    case: Case, length: Fraction | None = None, told: Callable[[float], None] | None = None, coverage: bool = False
) -> Profiled:
    """Run a case and return its profile. told: a callback that receives the fraction of the run that is done.

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
    scene.run(length, told)
    for name, profile in found.profiles.items():
        since = programs[name].asleep_since
        if since is not None:
            profile.slept(scene.kernel.now - since)
        profile.count_to(scene.kernel.now)
    return found
