"""A case made ready for a party outside: the case's file, and the lines that the party drives, go in.

at an SCI      its RX
at SDA, SCL    both

`scene.outside_parties` says which parties of the case it replaces there.
"""

from __future__ import annotations

from pathlib import Path

from ...scene.case.load import load
from ...scene.case.model import BadCase, Case
from ...scene.case.wiring import sci_named
from ...scene.outside_parties import with_outside
from ..errors import OutsideError
from ..i2c_master import LINES
from ..serial_line import module_of


def case_for_line(path: str | Path, port: str, changes: tuple[str, ...] = ()) -> Case:
    """OutsideError, or BadCase, one sentence, for a case that cannot be had or has no such SCI."""
    if not str(path):
        raise OutsideError("no case was given; f28335://PATH/OF/CASE.toml?port=scia")
    case = load(Path(path), list(changes))
    try:
        sci = sci_named(case, module_of(port), "outside")
    except BadCase as error:
        raise OutsideError(str(error)) from None
    return _driven(case, sci.rx)


def case_for_bus(path: str | Path, changes: tuple[str, ...] = ()) -> Case:
    """The same for SDA and SCL. BadCase for a case that cannot be had; one without a bus is refused by the session."""
    return _driven(load(Path(path), list(changes)), *LINES)


def _driven(case: Case, *lines: str) -> Case:
    """Return the case with these lines driven from outside, besides those that its [outside] names."""
    named = () if case.outside is None else case.outside.wires
    return with_outside(case, tuple(dict.fromkeys((*named, *lines))))
