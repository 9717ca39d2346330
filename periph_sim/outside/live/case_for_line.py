"""A case made ready for who is outside: the case's file, and where that is, go in; who gives way to it is left out.

at an SCI      the [host] of the case, with the budgets that speak of its frames
at SDA, SCL    the [controller] of the case, with the budgets that speak of its rounds
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ...processor.user_code import output_muted
from ...scene.case.load import load
from ...scene.case.model import BadCase, Case
from ...scene.case.wiring import sci_named
from ...scene.scene import Scene
from ..errors import OutsideError
from ..i2c_master import LINES
from ..serial_line import module_of


@dataclass(frozen=True)
class Ready:
    """wires: that lead outside. left_out: names of budgets that need who gives way."""

    case: Case
    wires: tuple[str, ...]
    left_out: tuple[str, ...]


def case_for_line(path: str | Path, port: str, changes: tuple[str, ...] = ()) -> Ready:
    """OutsideError, or BadCase, one sentence, for a case that cannot be had or has no such SCI."""
    if not str(path):
        raise OutsideError("no case was given; f28335://PATH/OF/CASE.toml?port=scia")
    case = load(Path(path), list(changes))
    case, left_out = without_host(case)
    try:
        sci = sci_named(case, module_of(port), "outside")
    except BadCase as error:
        raise OutsideError(str(error)) from None
    named = () if case.outside is None else case.outside.wires
    return Ready(case, tuple(dict.fromkeys((*named, sci.rx))), left_out)


def case_for_bus(path: str | Path, changes: tuple[str, ...] = ()) -> Ready:
    """The same for SDA and SCL. BadCase for a case that cannot be had; one without a bus is refused by the session."""
    case, left_out = without_controller(load(Path(path), list(changes)))
    named = () if case.outside is None else case.outside.wires
    return Ready(case, tuple(dict.fromkeys((*named, *LINES))), left_out)


@output_muted()
def without_controller(case: Case) -> tuple[Case, tuple[str, ...]]:
    """The case without its [controller], and the names of the budgets that mean nothing without it."""
    if case.controller is None:
        return case, ()
    Scene(case.model_copy(update={"outside": None}))  # what is wrong with it besides is told
    bare = case.model_copy(update={"controller": None, "budget": (), "breaks": (), "outside": None})
    kept, left_out = [], []
    for budget in case.budget:
        try:
            Scene(bare.model_copy(update={"budget": (budget,)}))
        except BadCase:
            left_out.append(budget.name)
        else:
            kept.append(budget)
    breaks = tuple(name for name in case.breaks if name not in left_out)
    update = {"budget": tuple(kept), "breaks": breaks, "outside": case.outside}
    return bare.model_copy(update=update), tuple(left_out)


@output_muted()
def without_host(case: Case) -> tuple[Case, tuple[str, ...]]:
    """The case without its [host], and the names of the budgets that went with it."""
    if case.host is None:
        return case, ()
    scene = Scene(case.model_copy(update={"outside": None}))
    compared = "wrong bytes" if case.controller is not None and case.controller.check == "host" else ""
    left_out = tuple(
        one.budget.name
        for one in scene.limits
        if one.budget.measure == compared or any(part.measure.needs == "host" for part in one.parts)
    )
    kept = tuple(budget for budget in case.budget if budget.name not in left_out)
    breaks = tuple(name for name in case.breaks if name not in left_out)
    update: dict[str, object] = {"host": None, "budget": kept, "breaks": breaks}
    if case.controller is not None and case.controller.check == "host":
        update["controller"] = case.controller.model_copy(update={"check": "expect"})
    return case.model_copy(update=update), left_out
