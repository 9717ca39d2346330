"""What a run's verdicts prove: a scene that has run goes in; each verdict gets its bound, and says what it proves.

case --two short runs--> bounds --beside limits and what was seen--> every phase, or seen and why
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from ...core.kernel import SimulationStuck
from ...f28335.system.memory_map import NoSuchAddress
from ...processor.error_origin import FirmwareError
from ...scene.case.model import BadCase, Case
from ...scene.firmware_loader import Firmware
from ...timing.budget_plan import PER_MILLE
from ...timing.budgets import BudgetJudge
from ...timing.format_value import in_words
from ...timing.verdict import EVERY_PHASE, SEEN, Verdict
from .deadlines import deadlines
from .form_of_case import closed_form
from .judged_run import JudgedRun
from .limits import LimitCheck, compare_with_limits, fitting_bound
from .program import Program
from .terms import BadBound, Bound


def prove_verdicts(scene: JudgedRun, verdicts: Iterable[Verdict]) -> None:
    """Say of each verdict of a scene's budgets, in their order, what is bounded and what a pass proves.

    Firmware that let no time pass would do so again in the runs for its terms, so none is made.
    """
    bounds, reason = ((), STALLED) if scene.stalled else bounds_of(scene.case, scene.firmware)
    for limit, verdict in zip(scene.limits, verdicts, strict=True):
        checks = compare_with_limits([limit], bounds)
        _say_bound(limit, verdict, bounds)
        if not verdict.passed:
            continue
        doubts = [_doubt(part, check) for part in limit.parts for check in checks if check.budget == part.budget.name]
        verdict.unbounded = reason or "; ".join(dict.fromkeys(filter(None, doubts)))
        verdict.proof = SEEN if verdict.unbounded else EVERY_PHASE


def _say_bound(limit: BudgetJudge, verdict: Verdict, bounds: Iterable[Bound]) -> None:
    """The bound of what the verdict shows, from the side of its limit.

    Where a percentile has none of its own the maximum's counts if it keeps the limit, and else says nothing.
    """
    shown = limit.shown
    bound = fitting_bound(shown.budget, verdict.which, bounds)
    if bound is None or bound.unproven:
        return
    if verdict.which not in PER_MILLE or bound.part < 1 or bound.ticks <= shown.limits[verdict.which]:
        verdict.bound = shown.show(bound.ticks)


def _doubt(part: BudgetJudge, check: LimitCheck) -> str:
    """Why a limit may be broken in another phase; empty if it cannot."""
    bound = check.bound
    if bound is None:
        return check.reason
    if not part.measure.silent and _beyond(part, check.key, bound):
        return f"the run went beyond the bound of {check.measure}, which is a fault of the bound; please report it"
    if not check.beyond:
        return ""
    unit = "us" if part.measure.unit == "time" else part.measure.unit
    if check.key in PER_MILLE and bound.part == 1:
        return f"only the maximum is bounded, by {in_words(part.show(bound.ticks), unit)}"
    return f"its bound is beyond the limit by {in_words(part.show(-(check.spare or 0)), unit)}"


def _beyond(part: BudgetJudge, key: str, bound: Bound) -> bool:
    """True if a run has gone beyond a bound."""
    if bound.least:
        return part.measure.least < bound.ticks
    seen = part.measure.worst if bound.part == 1 else part.measure.percentile(PER_MILLE[key])[0]
    return seen > bound.ticks


STALLED = "the firmware made no progress, so the run ended early; see the line that begins with 'stuck'"
Found = tuple[tuple[Bound, ...], str]
KEPT = 16  # cases whose bounds are kept in memory
APART = {"name", "about", "duration", "seed", "budget", "breaks"}  # what no bound depends on
_known: dict[tuple[object, ...], Found] = {}


def bounds_of(case: Case, firmware: Mapping[str, Firmware]) -> Found:
    """The bounds of a case; or none, and why. Kept for the next run of the same case, firmware and sources."""
    key = _key(case, firmware)
    found = _known.get(key)
    if found is None:
        found = _bounds_of(case, firmware)
        if len(_known) >= KEPT:
            _known.pop(next(iter(_known), key), None)  # other threads may have made room meanwhile
        _known[key] = found
    return found


def _key(case: Case, firmware: Mapping[str, Firmware]) -> tuple[object, ...]:
    """All that bounds depend on: the case but for its budgets, programs, and the texts of their sources."""
    mains = tuple((name, one.main) for name, one in sorted(firmware.items()))
    files = sorted({path for _, main in mains for path in Program(main).modules})
    said = repr({key: value for key, value in case.model_dump().items() if key not in APART})
    return (said, mains, tuple((path, Path(path).read_bytes()) for path in files))


def _bounds_of(case: Case, firmware: Mapping[str, Firmware]) -> Found:
    try:
        closed = closed_form(case, firmware)
        spare = deadlines(closed)
    except BadBound as error:
        return (), str(error).removeprefix(f"case {case.name}: ")
    except (BadCase, FirmwareError, NoSuchAddress, SimulationStuck) as error:
        return (), f"a run that measures the bounds' terms ends with an error: {error}"
    missed = [deadline.name for deadline in spare if deadline.ticks < 0]
    if missed:
        what = "in some phase the firmware comes too late for what a bound needs in time"
        return (), f"{what} ({', '.join(missed)}); `bound` shows by how much"
    return tuple(closed.bounds(spare)), ""
