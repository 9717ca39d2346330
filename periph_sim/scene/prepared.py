"""A prepared scene: a case that is prepared once and run any number of times, with changed keys.

    file or Case --> PreparedScene --scene(changes)--> Scene, not yet run
                                   --run(changes)----> Result

Everything that depends only on the case is computed once (`plan.ScenePlan`). If keys are changed, only the tables of
these keys are checked again, unless the case has [outside] or is not valid. Everything that a run changes is new in
each run: firmware modules, devices, wires, chips and random generators.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..core.input_files import inputs_of_one_command, note_inputs_of
from ..core.table import duration, separate
from .case.load import CaseFile
from .case.model import BadCase, Case
from .firmware_loader import Firmware
from .plan import ScenePlan
from .result import Result
from .scene import Scene

if TYPE_CHECKING:
    from ..core.records import Recorder
    from ..core.time import Timebase
    from ..devices.chips.register_chip import Source

Program = Callable[[Any, Any], None]

MOST_PLANS = 16  # maximum number of plans of changed cases that are kept, for runs with the same changes


class PreparedScene:
    """A case from which many scenes are built.

    case: a case from `load` or `make_case`, or the path of a file, which is read once.
    changes: "key=value" texts applied to the file for all runs; not allowed with a Case.

    Raise BadCase if the file cannot be read, or if a Case has nothing to run or comes with changes. `scene` and `run`
    raise BadCase if the file is not a valid case.
    """

    def __init__(self, case: Case | str | Path, changes: Sequence[str] = ()) -> None:
        self._file: CaseFile | None = None
        self._plans: dict[tuple[str, ...], ScenePlan] = {}
        self._unchanged: ScenePlan | None = None
        if isinstance(case, Case):
            _refuse_changes(changes)
            own = {name: separate(getattr(case, name)) for name in case.__struct_fields__}
            self._unchanged = ScenePlan(case.model_copy(update=own))
        else:
            self._file = CaseFile(case, changes)

    def plan(self, changes: Sequence[str] = ()) -> ScenePlan:
        """Return the plan of the case to which these changes are applied.

        Raise BadCase if this case is not valid, or if there are changes, but this object was made from a Case.
        """
        if self._file is None:
            _refuse_changes(changes)
        elif changes:
            return self._changed_plan(self._file, tuple(changes))
        elif self._unchanged is None:
            self._unchanged = ScenePlan(self._file.case)
        assert self._unchanged is not None
        return self._unchanged

    def _changed_plan(self, file: CaseFile, changes: tuple[str, ...]) -> ScenePlan:
        plan = self._plans.pop(changes, None)
        if plan is None:
            try:
                unchanged = self.plan()
            except BadCase:  # perhaps the file is a valid case only with the changes
                unchanged = None
            plan = ScenePlan(file.changed(changes), unchanged)
            if len(self._plans) == MOST_PLANS:
                del self._plans[next(iter(self._plans))]
        self._plans[changes] = plan
        return plan

    def scene(
        self,
        changes: Sequence[str] = (),
        subscribe: Callable[[Recorder, Timebase], None] | None = None,
        programs: Mapping[str, Firmware] | None = None,
        *,
        keep_values: bool = False,
        sources: Mapping[str, Source] | None = None,
    ) -> Scene:
        """Return a new scene of the case with these changes, not yet run. The other arguments are those of `Scene`."""
        plan = self.plan(changes)
        note_inputs_of(plan.case.files())
        return Scene(plan, subscribe, programs, keep_values=keep_values, sources=sources)

    def run(
        self,
        changes: Sequence[str] = (),
        *,
        seconds: str | Fraction | None = None,
        programs: Mapping[str, Program | Firmware] | None = None,
        record: str | Path | None = None,
    ) -> Result:
        """Run the case with these changes, and return the result, judged as `periph-sim run` judges it.

        seconds: the duration, such as "10 ms" or a Fraction, in place of the case's own.
        programs: a dictionary from a unit to firmware that is given as a function (dsp, settings). For this unit, the
            key `firmware` in the case is then only a name.
        record: a file for the records, in the format of its suffix.

        Raise BadCase, FirmwareError or a similar error, with one sentence, if the case cannot be run. Raise
        BadRecording if `record` has an unknown suffix, cannot be written, or is a file that this run has read.
        """
        case = self.plan(changes).case
        length, firmware = length_and_firmware(case, seconds, programs)
        if record is None:
            return self.scene(changes, None, firmware).run(length)
        from ..records.recording import recording

        with inputs_of_one_command():
            note_inputs_of(case.files())
            with recording(Path(record), case.recorded_modules) as (subscribe, ended_at):
                scene = self.scene(changes, subscribe, firmware)
                result = scene.run(length)
                ended_at(scene.kernel.now, scene.clocks())
        return result


def length_and_firmware(
    case: Case, seconds: str | Fraction | None, programs: Mapping[str, Program | Firmware] | None
) -> tuple[Fraction | None, dict[str, Firmware]]:
    """Return the duration of a run in seconds, and the firmware of units, from the arguments of `PreparedScene.run`.

    Raise BadCase if `seconds` is not a duration, or if the case has no unit with one of the names.
    """
    try:
        length = None if seconds is None else duration(seconds)
    except ValueError as error:
        raise BadCase(f"seconds={seconds!r}: {error}") from None
    firmware = {
        unit: program if isinstance(program, Firmware) else Firmware(unit, program, None)
        for unit, program in (programs or {}).items()
    }
    for unit in firmware.keys() - case.unit.keys():
        raise BadCase(f"programs: case {case.name} has no unit {unit!r}; it has {', '.join(case.unit) or 'none'}")
    return length, firmware


def _refuse_changes(changes: Sequence[str]) -> None:
    if changes:
        raise BadCase("changes go with a file; give them to load or make_case")
