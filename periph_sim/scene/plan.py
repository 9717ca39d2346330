"""The plan of a scene: what a case alone decides, worked out once for all scenes of it.

    Case --> ScenePlan: ticks, wiring, scope, what units, controller and host consist of --> Scene, any number of times

A plan holds nothing that a run changes, and nothing that another file than the case's says. Each part of a plan that is
kept for changed cases remembers the tables of the case that it was made of; the plan of a changed case takes over the
parts whose tables are the same objects, and makes the others anew.
"""

from __future__ import annotations

from collections.abc import Callable
from types import FunctionType, MethodType
from typing import TYPE_CHECKING, Any, TypeVar, cast

from msgspec import Struct

from ..core.time import Timebase, TimeError
from ..timing.language.scope import Scope
from . import parts
from .case.model import Case
from .case.wiring import Wiring, wiring_of
from .context import CaseTicks
from .scope import scope_of_case

if TYPE_CHECKING:
    from ..timing.budget_plan import BudgetPlan
    from .controller import HeadPlan
    from .host import HostPlan
    from .unit import UnitPlan

T = TypeVar("T")

OF_FILE = ("file", "folder")  # the same in all changed cases of a file


class _Part(Struct, frozen=True):
    """A part of a plan. tables: the fields of the case from which it was made."""

    value: Any
    tables: frozenset[str]


class ScenePlan:
    """The plan of one case.

    case: with the parties that its [outside] replaces taken out.
    before: the plan of a case that differs in some tables; its parts are taken over where their tables are the same.
    kept: notes what each part is made of, so that plans of changed cases can take it over.
    """

    def __init__(self, case: Case, before: ScenePlan | None = None, *, kept: bool = False) -> None:
        if not (case.unit or case.chip or case.device or case.controller or case.host):
            raise case.mistake("there is nothing to run; give it a [unit.NAME] with its firmware", "unit")
        if case.outside is not None:
            case = parts.outside_parties.as_driven(case)
        self.case = case
        self._before = before
        self._kept = kept
        self._parts: dict[str, _Part] = {}
        self._read: list[set[str]] = []  # the tables that each part which is being made has read so far

    @property
    def ticks(self) -> CaseTicks:
        """The converter of the case's times to ticks."""
        timebase, start = self._part("ticks", lambda plan, case: _timebase_and_start(case))
        return CaseTicks(self.case, timebase, start)

    @property
    def wiring(self) -> Wiring:
        return self._part("wiring", lambda plan, case: wiring_of(case))

    @property
    def scope(self) -> Scope:
        """The names that budgets may use.

        If another file defines some of them, they are read again at each access, since the file may have changed.
        """
        if self._names_of_files:
            return scope_of_case(self.case, self.wiring)
        return self._part("scope", lambda plan, case: scope_of_case(case, plan.wiring))

    @property
    def limits(self) -> tuple[BudgetPlan, ...]:
        """The plan of each budget, which is made anew if its names are, too. BadCase for an invalid budget."""
        if self._names_of_files:
            return parts.limits.limit_plans(self.ticks, self.scope)
        return self._part("limits", lambda plan, case: parts.limits.limit_plans(plan._ticks_of(case), plan.scope))

    @property
    def _names_of_files(self) -> bool:
        """True if another file than the case's defines names that budgets may use."""
        return bool(self.case.measures_from) or any(unit.image for unit in self.case.unit.values())

    def unit(self, name: str) -> UnitPlan:
        """Return what a unit consists of. BadCase for what it cannot have."""
        return self._part(
            f"unit {name}", lambda plan, case: parts.unit.unit_plan(plan._ticks_of(case), plan.wiring, name)
        )

    @property
    def head(self) -> HeadPlan:
        """The requests of the [controller] and their schedule. BadCase for requests that cannot be made."""
        return self._part("head", lambda plan, case: parts.controller.head_plan(plan._ticks_of(case)))

    @property
    def host(self) -> HostPlan:
        """The schedule of the [host]."""
        return self._part("host", lambda plan, case: parts.host.host_plan(plan._ticks_of(case)))

    def _ticks_of(self, case: Case) -> CaseTicks:
        """Return the ticks for a part that is made of this case."""
        ticks = self.ticks
        return CaseTicks(case, ticks.timebase, ticks.start)

    def _part(self, name: str, make: Callable[[ScenePlan, Case], T]) -> T:
        part = self._part_named(name, make)
        if self._read:
            self._read[-1].update(part.tables)
        return cast(T, part.value)

    def _part_named(self, name: str, make: Callable[[ScenePlan, Case], object]) -> _Part:
        part = self._parts.get(name)
        if part is None:
            part = self._parts[name] = self._taken_over(name, make) or self._made(make)
        return part

    def _taken_over(self, name: str, make: Callable[[ScenePlan, Case], object]) -> _Part | None:
        """Return the part of the plan before, if all its tables are the same objects here."""
        before = self._before
        if before is None:
            return None
        try:
            part = before._part_named(name, make)
        except ValueError:  # there is none in that case
            return None
        same = all(getattr(self.case, table) is getattr(before.case, table) for table in part.tables)
        return part if same else None

    def _made(self, make: Callable[[ScenePlan, Case], object]) -> _Part:
        if not self._kept:
            return _Part(make(self, self.case), frozenset())
        self._read.append(set())
        try:
            value = make(self, cast(Case, _ReadCase(self.case, self._read[-1])))
            return _Part(value, frozenset(self._read[-1]))
        except Exception:
            make(self, self.case)  # raises the same, with places that are found in the case itself
            raise
        finally:
            self._read.pop()


class _ReadCase:
    """A case that notes in `tables` the fields that are read of it, also by its own properties and methods."""

    def __init__(self, case: Case, tables: set[str]) -> None:
        self.__case = case
        self.__tables = tables

    def __getattr__(self, name: str) -> Any:
        if name in OF_FILE:
            return getattr(self.__case, name)
        known = getattr(Case, name, None)
        if isinstance(known, property):
            assert known.fget is not None
            return known.fget(self)
        if isinstance(known, FunctionType):
            return MethodType(known, self)
        self.__tables.add(name)
        return getattr(self.__case, name)


def _timebase_and_start(case: Case) -> tuple[Timebase, int]:
    timebase = Timebase(*(int(unit.oscclk * unit.pll / 2) for unit in case.unit.values()))
    try:
        return timebase, timebase.ticks(case.start, "nearest")
    except TimeError as error:
        raise case.mistake(str(error), "start") from None
