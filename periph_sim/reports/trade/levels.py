"""The levels that a case can run at: a case goes in; levels, as changes of the case, come out.

    fidelity                edge, the reference, what else `fidelity` takes, and the case's own table of it
    arithmetic              where the firmware has a setting of that name
    skip_polls, poll_pass   how waiting firmware polls

A new value of `fidelity` is a level as soon as cases take it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass

from ...core.suggest import did_you_mean
from ...scene.case.fidelity import LEVELS, fidelity_text
from ...scene.case.model import BadCase, Case
from ...scene.firmware_loader import BadFirmware, load_firmware

FIDELITIES = LEVELS
REFERENCE = "edge"
SAME_RECORDS = (REFERENCE, "adaptive")  # as edge in every scene (tests/scene/test_adaptive.py)
ARITHMETICS = ("bytes", "q16", "float32", "float64")
POLL_PASSES = (7, 21)  # the shortest and the longest pass that was counted in compiled programs (docs/fidelity.md)


@dataclass(frozen=True)
class Level:
    """changes: of the case, as `--set` has them. same_records: as the reference has, in every scene."""

    name: str
    changes: tuple[str, ...]
    same_records: bool = False


def level_of(fidelity: str) -> Level:
    return Level(fidelity, (f"fidelity={fidelity}",), fidelity in SAME_RECORDS)


def fidelities_of(case: Case) -> tuple[Level, ...]:
    """The reference first, then the other words, and the case as it is where it says a level for each bus."""
    others = [level_of(name) for name in FIDELITIES if name != REFERENCE]
    if isinstance(case.fidelity, str):
        return (level_of(REFERENCE), *others)
    same = all(level in SAME_RECORDS for level in case.fidelity.values())
    return (level_of(REFERENCE), *others, Level(fidelity_text(case.fidelity), (), same))


def levels_of(case: Case) -> list[Level]:
    """The reference first, then all others that make a difference to this case's text."""
    return [*fidelities_of(case), *_arithmetics(case), *_poll_models(case)]


def chosen(levels: list[Level], names: tuple[str, ...]) -> list[Level]:
    """The reference and the levels of these names; all if none is named. BadCase for a name that is none."""
    known = {level.name: level for level in levels}
    for name in names:
        if name not in known:
            raise BadCase(f"there is no level {name!r} of this case; {did_you_mean(name, list(known))}")
    return [level for level in levels if not names or level.name in names or level.name == REFERENCE]


def _arithmetics(case: Case) -> Iterator[Level]:
    """Of all units together whose firmware computes."""
    current = {name: unit.settings.get("arithmetic", _default(unit.firmware)) for name, unit in case.unit.items()}
    computing = {name: now for name, now in current.items() if now is not None}
    for arithmetic in ARITHMETICS:
        if computing and set(computing.values()) != {arithmetic}:
            changes = (f"unit.{unit}.settings.arithmetic={arithmetic}" for unit in computing)
            yield Level(f"arithmetic={arithmetic}", _at_edges(*changes))


def _default(firmware: str) -> object:
    """The arithmetic that firmware computes in where a case says nothing; None where it has no such setting."""
    try:
        settings = load_firmware(firmware).settings
    except BadFirmware:
        return None
    if not isinstance(settings, type) or not is_dataclass(settings):
        return None
    return next((field.default for field in fields(settings) if field.name == "arithmetic"), None)


def _poll_models(case: Case) -> Iterator[Level]:
    """The instructions of an image say what a pass costs, so `poll_pass` is of the other units alone."""
    if any(unit.skip_polls for unit in case.unit.values()):
        yield Level("skip_polls=false", _at_edges(*(f"unit.{name}.skip_polls=false" for name in case.unit)))
    costed = {name: unit.code for name, unit in case.unit.items() if not unit.image}
    for cycles in POLL_PASSES:
        if any(code.poll_pass != cycles for code in costed.values()):
            changes = (f"unit.{name}.code.poll_pass={cycles}" for name in costed)
            yield Level(f"poll_pass={cycles}", _at_edges(*changes))


def _at_edges(*changes: str) -> tuple[str, ...]:
    return (f"fidelity={REFERENCE}", *changes)
