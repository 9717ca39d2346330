"""Installs the skipping of I2C bits in a scene. The party that clocks the bus requests it before each byte."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..bus.i2c.bit_skip import BitParty, BitSkip
from ..bus.i2c.skipping_controller import SkippingController
from ..core.agent import Agent
from .context import SceneContext

if TYPE_CHECKING:
    from ..bus.i2c.controller import I2cController
    from ..processor.dsp import Dsp

MODULE = "I2C-A"


def bit_skip_of(context: SceneContext, controller: I2cController | None, units: Mapping[str, Dsp]) -> BitSkip:
    """Return the object that skips bits on SCL and SDA.

    The controller agent clocks the bus; without one it is the unit that is the master.
    """
    modules: dict[Agent, BitParty] = {}
    bit_skip = BitSkip(context.kernel, context.wire("SCL"), context.wire("SDA"), controller, modules)
    for dsp in units.values():
        if MODULE in dsp.sockets:
            from ..processor.i2c_bit_skip import party_of  # a scene without the module does not import it

            socket = dsp.socket(MODULE)
            modules[socket] = party_of(socket, dsp.clock, bit_skip, clocks=controller is None)
    if controller is not None:
        assert isinstance(controller, SkippingController)
        controller.bit_skip = bit_skip
    return bit_skip
