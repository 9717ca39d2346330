"""Functions for Python programs: a case from tables or a file, and the judged result of its run.

make_case(...) or load(file) --> Case --run--> Result
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from .core.convert import BadTable
from .scene.case.load import apply, built, refusal
from .scene.case.model import Case
from .scene.case.origin import Source, texts_in
from .scene.firmware_loader import Firmware
from .scene.prepared import PreparedScene, Program
from .scene.result import Result


def make_case(changes: Sequence[str] = (), **tables: Any) -> Case:
    """Return the case of these tables, as of a file: make_case(name="mine", duration="10 ms", unit={...}).

    changes: "key=value" texts, as for `--set`. BadCase with one sentence if a table is wrong.
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
    """Run a case and return its judged result, as `periph-sim run` does.

    case: of `load` or `make_case`, or a file, to which `changes` apply. seconds: instead of the case's own: "10 ms"
    or a Fraction. programs: firmware given as functions (dsp, settings), by unit; the unit's own `firmware` is then
    only a name. record: a file for the records; its suffix says the format.

    BadCase or FirmwareError, one sentence each, if it cannot be run; BadRecording if `record` has no known suffix,
    cannot be written, or is a file that this run has read.
    """
    return PreparedScene(case, changes).run(seconds=seconds, programs=programs, record=record)
