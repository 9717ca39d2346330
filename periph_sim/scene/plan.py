"""The plan of a scene: everything that depends only on the case, computed once for all its scenes.

    Case --> ScenePlan: ticks, wiring, names and plans of budgets, plans of units, controller and host --> Scenes

A plan contains nothing that a run changes. Budgets may use names from two kinds of files besides the case: variables
and functions of an image, and the measures in the file of the key `measures_from`. These files are read again for each
scene.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from ..core.time import Timebase, TimeError
from ..timing.language.scope import Scope
from . import parts
from .case.model import Case
from .case.wiring import Wiring, wiring_of
from .context import CaseTicks
from .scope import scope_of_case

if TYPE_CHECKING:
    from ..processor.dsp import DspPlan
    from ..timing.budget_plan import BudgetPlan
    from .controller import HeadPlan
    from .host import HostPlan


class ScenePlan:
    """The plan of one case.

    case: the case without the parties that its [outside] replaces.
    before: if this case is a copy of another case with changed keys, the plan of the other case; else None. If both
        cases have the same budgets, the plans of the budgets are reused, because making them takes much time.
    """

    def __init__(self, case: Case, before: ScenePlan | None = None) -> None:
        if not (case.unit or case.chip or case.device or case.controller or case.host):
            raise case.mistake("there is nothing to run; give it a [unit.NAME] with its firmware", "unit")
        if case.outside is not None:
            case = parts.outside_parties.as_driven(case)
        self.case = case
        self._before = before
        self._units: dict[str, DspPlan] = {}
        self._scope: Scope | None = None
        self._limits: tuple[BudgetPlan, ...] | None = None

    @cached_property
    def ticks(self) -> CaseTicks:
        """The converter of the case's times to ticks. Raise BadCase if `start` has too many ticks."""
        case = self.case
        timebase = Timebase(*(int(unit.oscclk * unit.pll / 2) for unit in case.unit.values()))
        try:
            return CaseTicks(case, timebase, timebase.ticks(case.start, "nearest"))
        except TimeError as error:
            raise case.mistake(str(error), "start") from None

    @cached_property
    def wiring(self) -> Wiring:
        return wiring_of(self.case)

    @property
    def scope(self) -> Scope:
        """The names that budgets may use.

        If some of these names are defined in a file other than the case's, all names are read again at each access,
        because that file may have changed.
        """
        if self._scope is None or self._names_of_files:
            self._scope = scope_of_case(self.case, self.wiring)
        return self._scope

    @property
    def _names_of_files(self) -> bool:
        """True if a file other than the case's defines names that budgets may use."""
        return bool(self.case.measures_from) or any(unit.image for unit in self.case.unit.values())

    @property
    def limits(self) -> tuple[BudgetPlan, ...]:
        """The plans of the budgets. They are made again at each access if `scope` is read again at each access.

        Raise BadCase for an invalid budget or unit.
        """
        if self._limits is None or self._names_of_files:
            # The units are checked first: if the table of a unit misspells a module, budgets that name the module are
            # invalid, too, but the mistake in the table must be reported.
            for name in self.case.unit:
                self.unit(name)
            before = None if self._names_of_files else self._before
            self._limits = self._limits_as(before) or limit_plans(self.ticks, self.scope)
        return self._limits

    def _limits_as(self, other: ScenePlan | None) -> tuple[BudgetPlan, ...]:
        """Return the budget plans of `other` if both cases have the same budgets, names and ticks; else ()."""
        try:
            if other is None or other.case.budget is not self.case.budget or self.scope != other.scope:
                return ()
            one, two = self.ticks, other.ticks
            same_ticks = (one.timebase.per_second, one.start) == (two.timebase.per_second, two.start)
            return other.limits if same_ticks else ()
        except ValueError:  # the case of `other` is not valid
            return ()

    def unit(self, name: str) -> DspPlan:
        """Return the plan of a unit. Raise BadCase for an unknown part, module or option, or a wrong answer."""
        if name not in self._units:
            self._units[name] = parts.unit.unit_plan(self.ticks, name)
        return self._units[name]

    @cached_property
    def head(self) -> HeadPlan:
        """The requests of the [controller] and their schedule. Raise BadCase for invalid requests or times."""
        return parts.controller.head_plan(self.ticks)

    @cached_property
    def host(self) -> HostPlan:
        """The schedule of the [host], and the length of a bit on RX. Raise BadCase for a time with too many ticks."""
        return parts.host.host_plan(self.ticks)


def limit_plans(ticks: CaseTicks, scope: Scope) -> tuple[BudgetPlan, ...]:
    """Return the plan of each budget, in the order of the case.

    Raise BadCase for an invalid budget, or if two budgets have the same name.
    """
    from ..timing.budget_plan import BadBudget, plan_of

    case = ticks.case
    found: list[BudgetPlan] = []
    names: set[str] = set()
    for entry, budget in enumerate(case.budget):
        if budget.name in names:
            what = f"there are two budgets {budget.name!r}; verdicts are known by name, so rename one of them"
            raise case.mistake(what, "budget", entry, "name")
        names.add(budget.name)
        try:
            found.append(plan_of(budget, ticks.timebase, scope, ticks.start, found))
        except BadBudget as error:
            raise case.mistake(str(error), "budget", entry, *error.place) from None
    return tuple(found)
