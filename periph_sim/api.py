"""What Python programs call besides the classes themselves: tables or a file go in, a case and its judged run come out.

make_case(...) or load(file) --> Case --run--> Result
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from .core.convert import BadTable
from .core.input_files import inputs_of_one_command, note_inputs_of
from .core.settings import duration
from .records.if_recorded import if_recorded
from .scene.case.load import apply, built, load, refusal
from .scene.case.model import BadCase, Case
from .scene.case.named_files import texts_in
from .scene.case.origin import Source
from .scene.clocks import clocks_of
from .scene.firmware_loader import Firmware
from .scene.result import Result
from .scene.scene import Scene

Program = Callable[[Any, Any], None]


def make_case(changes: Sequence[str] = (), **tables: Any) -> Case:
    """The case that these tables say, as a file would: make_case(name="mine", duration="10 ms", unit={...}).

    changes: "key=value" texts, as `--set` has them. BadCase with one sentence where a table is wrong.
    """
    tree = dict(tables)
    places = tuple((change, apply(tree, change)) for change in changes)
    source = Source(Path(f"make_case({tables.get('name', '')})"), "", places, tuple(texts_in(tree)))
    try:
        return built(Case.model_validate(tree), source)
    except BadTable as error:
        raise refusal(source, error, tree) from None


def run(
    case: Case | str | Path,
    changes: Sequence[str] = (),
    *,
    seconds: str | Fraction | None = None,
    programs: Mapping[str, Program | Firmware] | None = None,
    record: str | Path | None = None,
) -> Result:
    """What a run of the case came to, judged as `periph-sim run` judges it.

    case: of `load` or `make_case`, or a file, to which `changes` apply. seconds: instead of the case's own: "10 ms"
    or a Fraction. programs: firmware given as functions (dsp, settings), by unit; the unit's own `firmware` is then
    only a name. record: a file for the records; its suffix says the format.

    BadCase, FirmwareError and their like, one sentence each, where it cannot be run; BadRecording where `record` is a
    file that this run has read.
    """
    with inputs_of_one_command():
        return _run(case, changes, seconds, programs or {}, record)


def _run(
    case: Case | str | Path,
    changes: Sequence[str],
    seconds: str | Fraction | None,
    programs: Mapping[str, Program | Firmware],
    record: str | Path | None,
) -> Result:
    if isinstance(case, Case):
        if changes:
            raise BadCase("changes go with a file; give them to load or make_case")
    else:
        case = load(Path(case), list(changes))
    note_inputs_of(case.files())
    try:
        length = None if seconds is None else duration(seconds)
    except ValueError as error:
        raise BadCase(f"seconds={seconds!r}: {error}") from None
    firmware = {unit: _firmware(unit, program) for unit, program in programs.items()}
    for unit in firmware.keys() - case.unit.keys():
        raise BadCase(f"programs: case {case.name} has no unit {unit!r}; it has {', '.join(case.unit) or 'none'}")
    with if_recorded(None if record is None else Path(record), case.recorded_modules) as (subscribe, ended_at):
        scene = Scene(case, subscribe, firmware)
        result = scene.run(length)
        ended_at(scene.kernel.now, clocks_of(scene))
    return result


def _firmware(unit: str, program: Program | Firmware) -> Firmware:
    return program if isinstance(program, Firmware) else Firmware(unit, program, None)
