"""Levels above edges: a scene's controller and units go in; bytes pass at once where nobody can tell, or all in steps.

"byte" is refused where it could not be: a bus without a controller agent, recorded edges, parties that pull lines as
they like.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

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
from .case.model import Case
from .context import SceneContext

MODULE = "I2C-A"
LINES = ("SCL", "SDA")


LEVELS = {"adaptive": WholeBytes, "byte": ByteLevel}


def whole_bytes_of(context: SceneContext, controller: I2cController | None, units: Mapping[str, Dsp]) -> WholeBytes:
    """Who clocks asks it from now on, byte by byte: the agent, where there is one, else whichever unit is the master.

    Bytes of a unit pass as at "adaptive" at "byte", too.
    """
    level = WholeBytes if controller is None else LEVELS[context.case.fidelity]
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


def refuse_schedule(case: Case) -> None:
    """BadCase for a case of level "schedule", which has neither wires nor records: levels.schedule knows it."""
    if case.fidelity == "schedule":
        what = '"schedule" has neither wires nor records: it is for run, sweep and trade'
        raise case.mistake(f'{what}; here use "edge", or "adaptive" with the same records', "fidelity")


def refuse_byte_level(
    case: Case, whole_bytes: WholeBytes | None, wires: Mapping[str, Wire], limits: Sequence[BudgetJudge]
) -> None:
    """BadCase where this scene, as it is built, cannot run at level "byte". limits: its budgets."""
    if case.fidelity != "byte":
        return
    strangers: list[str] = []
    if whole_bytes is not None:  # a unit's pins become its module's as firmware routes them
        strangers = sorted({who.partition(".")[0] for who in whole_bytes.strangers()}.difference(case.unit))
    if whole_bytes is None:
        what = "there is no I2C bus"
    elif any(wires[name].recorded for name in LINES):
        what = f"{_who_wants_edges(limits)}, and bytes have none"
    elif strangers:
        what = f"{' and '.join(strangers)} may pull SCL and SDA edge by edge"
    else:
        return
    raise case.mistake(f'"byte" cannot be: {what}; use "edge", or "adaptive" with the same records', "fidelity")


def _who_wants_edges(limits: Sequence[BudgetJudge]) -> str:
    """A budget, or else whoever records this run."""
    for limit in limits:
        asked = Recorder()
        for measure in limit.own_measures:
            measure.subscribe(asked)
        if any(asked.wants(Kind.EDGE, name) for name in LINES):
            return f"budget {limit.budget.name!r} looks at edges of SCL and SDA"
    return "edges of SCL and SDA are recorded (--record, worst and others do)"
