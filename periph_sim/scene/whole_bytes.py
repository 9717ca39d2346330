"""Levels above edges: a scene's controller and units go in; bytes pass at once where nobody can tell, or all in steps.

"byte" is refused where it could not be: neither I2C nor an SCI, recorded edges, parties that pull lines as they like.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

from ..bus.i2c.byte_controller import ByteController
from ..bus.i2c.byte_level import ByteLevel
from ..bus.i2c.controller import I2cController
from ..bus.i2c.whole_bytes import ByteParty, WholeBytes
from ..core.kernel import Agent
from ..core.records import Kind, Recorder
from ..core.wire import Wire
from ..f28335.i2c.module import I2c
from ..processor.dsp import Dsp
from ..processor.i2c_master_bytes import I2cMasterBytes
from ..processor.i2c_slave_bytes import I2cSlaveBytes
from ..timing.budgets import BudgetJudge
from .case.fidelity import BYTE, I2C
from .case.model import BadCase, Case
from .context import SceneContext

if TYPE_CHECKING:
    from .whole_frames import FramesSide

MODULE = "I2C-A"
LINES = ("SCL", "SDA")

LEVELS = {"adaptive": WholeBytes, "byte": ByteLevel}


def whole_bytes_of(context: SceneContext, controller: I2cController | None, units: Mapping[str, Dsp]) -> WholeBytes:
    """Who clocks asks it from now on, byte by byte: the agent, where there is one, else whichever unit is the master.

    Bytes of a unit pass as at "adaptive" at "byte", too.
    """
    level = WholeBytes if controller is None else LEVELS[context.levels.i2c]
    exact = level is WholeBytes
    scl, sda = context.wire("SCL"), context.wire("SDA")
    stand_in: dict[Agent, ByteParty] = {}
    masters: list[I2cMasterBytes] = []
    for dsp in units.values():
        if MODULE in dsp.sockets:
            socket = dsp.socket(MODULE)
            assert isinstance(socket.chip, I2c)
            stand_in[socket] = module = I2cSlaveBytes(context.kernel, socket, socket.chip, dsp.clock, scl, sda, exact)
            masters.append(module.master)
    whole_bytes = level(context.kernel, scl, sda, controller, stand_in)
    if controller is None:
        for master in masters:
            master.let_pass(whole_bytes)
    else:
        assert isinstance(controller, ByteController)
        controller.let_pass(whole_bytes)
    return whole_bytes


def refuse_byte_level(
    context: SceneContext,
    whole_bytes: WholeBytes | None,
    frames: FramesSide | None,
    wires: Mapping[str, Wire],
    limits: Sequence[BudgetJudge],
) -> None:
    """BadCase where a bus of this scene, as it is built, cannot be at level "byte". limits: its budgets."""
    case, levels = context.case, context.levels
    if whole_bytes is None and frames is None:
        raise _cannot_be(case, "", "there is neither an I2C bus nor an SCI")
    if whole_bytes is not None and levels.i2c == BYTE:  # a unit's pins become its module's as firmware routes them
        strangers = {who.partition(".")[0] for who in whole_bytes.strangers()}.difference(case.unit)
        _refuse(case, "" if isinstance(case.fidelity, str) else I2C, _why_edges(LINES, strangers, wires, limits))
    for name, line in ({} if frames is None else frames.lines).items():
        if levels.lines[name] == BYTE:
            _refuse(case, levels.named[name], _why_edges((name,), line.strangers(), wires, limits))


def _refuse(case: Case, bus: str, why: str) -> None:
    if why:
        raise _cannot_be(case, bus, why)


def _cannot_be(case: Case, bus: str, why: str) -> BadCase:
    """bus: as the table of fidelities names it; "" where there is one word for the scene."""
    what = f'"byte" cannot be: {why}; use "edge", or "adaptive" with the same records'
    return case.mistake(what, "fidelity", *bus.split(".") if bus else ())


def _why_edges(
    lines: Sequence[str], strangers: Collection[str], wires: Mapping[str, Wire], limits: Sequence[BudgetJudge]
) -> str:
    """What keeps these wires from being without edges, as a phrase."""
    if any(wires[name].recorded for name in lines):
        return f"{_who_wants_edges(lines, limits)}, and bytes have none"
    return f"{' and '.join(sorted(strangers))} may pull {' and '.join(lines)} edge by edge" if strangers else ""


def _who_wants_edges(lines: Sequence[str], limits: Sequence[BudgetJudge]) -> str:
    """A budget, or else whoever records this run."""
    named = " and ".join(lines)
    for limit in limits:
        asked = Recorder()
        for measure in limit.own_measures:
            measure.subscribe(asked)
        if any(asked.wants(Kind.EDGE, name) for name in lines):
            return f"budget {limit.budget.name!r} looks at edges of {named}"
    return f"edges of {named} are recorded (--record, worst and others do)"
