"""Preparation of a case for an external party that drives some of its lines.

a party at an SCI      drives its RX
a party at SDA, SCL    drives both

`scene.outside_parties` defines which parties of the case the external party replaces.
"""

from __future__ import annotations

from pathlib import Path

from ...scene.case.load import load
from ...scene.case.model import Case
from ...scene.outside_parties import with_outside
from ..errors import OutsideError
from ..i2c_master import LINES
from ..serial_line import sci_of


def case_for_line(path: str | Path, port: str, changes: tuple[str, ...] = ()) -> Case:
    """Load a case, and return it with the RX line of one of its SCIs leading outside.

    path: the file of the case.
    port: the name of the SCI, such as "scia" or "dsp.SCI-A".
    changes: texts such as "key=value", which replace values of the case.

    Raise OutsideError or BadCase if the case has errors or does not have this SCI.
    """
    if not str(path):
        raise OutsideError("no case was given; f28335://PATH/OF/CASE.toml?port=scia")
    case = load(Path(path), list(changes))
    return _driven(case, sci_of(case, port).rx)


def case_for_bus(path: str | Path, changes: tuple[str, ...] = ()) -> Case:
    """Load a case, and return it with SDA and SCL leading outside. path, changes: as for `case_for_line`.

    Raise BadCase if the case has errors. A case without a bus is rejected later, by `Session`.
    """
    return _driven(load(Path(path), list(changes)), *LINES)


def _driven(case: Case, *lines: str) -> Case:
    """Return the case with these lines added to those in its [outside] table, so that they lead outside."""
    named = () if case.outside is None else case.outside.wires
    return with_outside(case, tuple(dict.fromkeys((*named, *lines))))
