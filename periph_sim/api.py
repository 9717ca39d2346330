"""Functions for Python programs: make a case from tables, and run a case and judge the result.

make_case(...) or load(file) --> Case --run--> Result
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .scene.case.load import case_of_tables
from .scene.case.model import Case
from .scene.firmware_loader import Firmware
from .scene.prepared import PreparedScene, Program
from .scene.result import Result

if TYPE_CHECKING:
    from .proof.scenarios import Scenarios


def make_case(changes: Sequence[str] = (), **tables: Any) -> Case:
    """Return a case with the tables of a case file: make_case(name="mine", duration="10 ms", unit={...}).

    changes: texts "key=value", which change the tables as `--set` does.

    Raise BadCase if a table or a change is invalid.
    """
    return case_of_tables(tables, f"make_case({tables.get('name', '')})", changes)


def scenarios(case: str | Path, changes: Sequence[str] = ()) -> Scenarios:
    """Return an object that computes the values of a case's budgets for sequences of start times.

    A start is the beginning of a round of the controller, or of a frame of the host. This function runs the case to
    make its closed table (docs/proof.md), which takes seconds to minutes. `Scenarios.values` then looks up the values
    of many sequences in the table, without further runs. `Scenarios.starts` draws sequences from seeds, as runs do.

    case: the path of a case with one unit, which runs an image. The times at which rounds start are free, or those at
        which frames start, but not both.
    changes: texts "key=value" that change the case as `--set` does.

    Raise BadCase if the case cannot be read, has no closed table, or fails in a run of its table.
    """
    from .proof.scenarios import Scenarios  # imported here, because only this function needs the proofs

    return Scenarios(case, changes)


def run(
    case: Case | str | Path,
    changes: Sequence[str] = (),
    *,
    seconds: str | Fraction | None = None,
    programs: Mapping[str, Program | Firmware] | None = None,
    record: str | Path | None = None,
) -> Result:
    """Run a case and return its judged result, as `periph-sim run` does.

    case: the result of `load` or `make_case`, or the path of a case file.
    changes: texts "key=value" that change a case file as `--set` does. They are only accepted with a path.
    seconds: the duration of the run, as a text such as "10 ms" or as a Fraction; None for the duration of the case.
    programs: a dictionary from the name of a unit to its firmware, as a function (dsp, settings) or a Firmware. The key
        `firmware` of such a unit in the case is then only a name for messages.
    record: the path of a file for the records of the run. Its suffix determines the format.

    Raise BadCase or FirmwareError if the case cannot be run, and BadRecording if `record` has no known suffix, cannot
    be written, or is a file that this run has read.
    """
    return PreparedScene(case, changes).run(seconds=seconds, programs=programs, record=record)
