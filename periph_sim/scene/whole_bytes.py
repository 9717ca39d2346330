"""The level "adaptive": a scene's controller and units go in; they let bytes pass at once where nobody can tell."""

from __future__ import annotations

from collections.abc import Mapping

from ..bus.i2c.controller import I2cController
from ..bus.i2c.whole_bytes import ByteParty, WholeBytes
from ..core.kernel import Agent
from ..f28335.i2c.module import I2c
from ..processor.dsp import Dsp
from ..processor.i2c_slave_bytes import I2cSlaveBytes
from .context import SceneContext

MODULE = "I2C-A"


def whole_bytes_of(context: SceneContext, controller: I2cController, units: Mapping[str, Dsp]) -> WholeBytes:
    """The controller asks it from now on, byte by byte."""
    stand_in: dict[Agent, ByteParty] = {}
    for dsp in units.values():
        if MODULE in dsp.sockets:
            socket = dsp.socket(MODULE)
            assert isinstance(socket.chip, I2c)
            stand_in[socket] = I2cSlaveBytes(socket, socket.chip, dsp.clock)
    whole_bytes = WholeBytes(context.kernel, context.wire("SCL"), context.wire("SDA"), controller, stand_in)
    controller.whole_bytes = whole_bytes
    return whole_bytes
