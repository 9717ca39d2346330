"""The choices for a scene in a comparison of speed and accuracy. Each choice is a row; the most accurate one is first.

firmware     the firmware of the case or of another case: an image, C sources, or Python with stated costs
arithmetic   the number format of sensor models in Python firmware, at the cost that the case states
recording    none, .psr or .vcd
table        no runs, but values of budgets from the closed table of the case, if it has one
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from ....core.phrases import did_you_mean
from ....proof.free_run import NotClosed
from ....proof.phases import moved_starts
from ....proof.table_cases import check
from ....scene.case.model import BadCase, Case
from ....scene.case.unit_table import Unit
from ....scene.firmware_loader import BadFirmware, BadSetting, load_firmware, settings_for

# Kinds of firmware, the most accurate first: the cycles of instructions are known, estimated from C, or stated.
KINDS = ("image", "C", "Python")
ARITHMETICS = ("float64", "float32", "q16")
RECORDINGS = (".psr", ".vcd")
BYTES = "bytes"  # the value of the setting `arithmetic` for firmware without sensor models
AS_GIVEN = "as given"
TABLE = "table"
Make = Callable[[Sequence[str]], Case]


@dataclass(frozen=True)
class Row:
    """One choice for the scene: a row of the table of results.

    changes: the changes of the case, as texts "key=value".
    units: another case whose units are used; None to use the units of the case itself.
    record: the suffix of the recording to write; "" for no recording.
    missing: the reason why the case does not have this row; "" if it has.
    """

    name: str
    changes: tuple[str, ...] = ()
    units: Case | None = None
    record: str = ""
    missing: str = ""

    def case(self, make: Make) -> Case:
        """Return the case to run. Raise BadCase if the changes do not fit the case.

        make: a function that returns the case with some changes.
        """
        case = make(self.changes)
        return case if self.units is None else case.model_copy(update={"unit": self.units.unit})


HAS_TABLE = Row(TABLE)  # the row of a case that may have a closed table; it is not run


def rows_of(make: Make, others: Sequence[Case]) -> list[Row]:
    """Return all rows of a case.

    make: a function that returns the case with the changes in a list of texts "key=value".
    others: other cases. For each of them there is a row in which its units, with their firmware, replace those of the
        case.
    """
    case = make(())
    firmware = [(kind_of(case), [*_arithmetics(case, Row(AS_GIVEN))])]
    firmware += [(kind, [Row(f"{kind} of {other.name}", units=other)]) for other in others if (kind := kind_of(other))]
    found = [row for _, rows in sorted(firmware, key=lambda one: KINDS.index(one[0])) for row in rows]
    recorded = [Row(f"record {suffix}", record=suffix) for suffix in RECORDINGS]
    return [*found, *recorded, Row(TABLE, missing=why_no_table(case))]


def chosen(rows: Sequence[Row], names: Sequence[str]) -> list[Row]:
    """Return the rows with these names, and always the most accurate row and the row of the unchanged case, "as given".

    If no name is given, return all rows that the case has.

    Raise BadCase if there is no row with one of these names.
    """
    known = [row.name for row in rows]
    for name in names:
        if name not in known:
            raise BadCase(f"there is no row {name!r} of this case; {did_you_mean(name, known)}")
    if not names:
        return [row for row in rows if not row.missing]
    return [row for row in rows if row.name in (rows[0].name, AS_GIVEN, *names)]


def why_no_table(case: Case) -> str:
    """Return why a case cannot have a closed table; "" if it can, as far as is known before the table is made."""
    try:
        check(case)
        moved_starts(case)
    except (NotClosed, BadCase) as error:
        return str(error)
    return ""


def kind_of(case: Case) -> str:
    """Return the kind of a case's firmware. If the case has several units, return the least accurate kind."""
    kinds = ["image" if unit.image else "C" if unit.sources else "Python" for unit in case.unit.values()]
    return max(kinds, key=KINDS.index, default="Python")


def _arithmetics(case: Case, given: Row) -> Iterator[Row]:
    """Yield a row for the unchanged case and, if there are sensor models, for each other number format.

    The most accurate format comes first.
    """
    settings = {name: _settings(unit) for name, unit in case.unit.items() if unit.firmware}
    computing = {name: one for name, one in settings.items() if getattr(one, "arithmetic", BYTES) != BYTES}
    present = {getattr(one, "arithmetic", BYTES) for one in computing.values()}
    first = next((arithmetic for arithmetic in ARITHMETICS if arithmetic in present), "")
    for arithmetic in ARITHMETICS:
        if arithmetic == first:
            yield given
        elif computing:
            changes = [change for name, one in computing.items() for change in _computed_in(arithmetic, name, one)]
            yield Row(f"arithmetic={arithmetic}", tuple(changes))
    if not first:
        yield given


def _settings(unit: Unit) -> object:
    """Return the settings of a unit's firmware; None if the settings are wrong, which the run will report."""
    try:
        return settings_for(load_firmware(unit.firmware), unit.settings)
    except (BadFirmware, BadSetting):
        return None


def _computed_in(arithmetic: str, unit: str, settings: object) -> Iterator[str]:
    """Yield the changes, as "key=value", that make the sensor models of a unit calculate in another number format.

    The computing time of the models stays as it is: if the case estimates it, which depends on the format, the estimate
    for the present format becomes a fixed time.

    arithmetic: the other format. unit: the name of the unit. settings: the present settings of its firmware.
    """
    yield f"unit.{unit}.settings.arithmetic={arithmetic}"
    if getattr(settings, "model_cost", None) == "estimate":
        yield f"unit.{unit}.settings.model_cost={getattr(settings, 'run_cost', '')}"
        yield f"unit.{unit}.settings.beyond_estimate=0 s"
