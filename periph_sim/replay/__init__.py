"""Replay of captures against firmware.

Capture, Case --> I2cReplay, UartReplay ... --run--> Report: the first differences between capture and replay

Terms of this package:

capture: the edges of wires that a logic analyser has recorded.
case: the description of a simulation: units, firmware and its settings, budgets.
unit: a simulated DSP. The firmware of a unit takes the place of a device in the capture, as target or as controller.
    In texts about the DSP's own module, a target is called slave and a controller master, as in TI's manuals.
chip: the simulated F28335 of the unit whose firmware is replayed.
agent: a simulated party on the wires that is not a unit, for example the controller or the other targets of a bus.
player: the agent that drives the captured edges on the wires.
move: a change of SCL or SDA by the player, with the time since its previous move.
session: an I2C capture and a UART capture that are replayed together.
position: a time in a capture, which is the number of a sample or the value of a time stamp.
tick: the unit of simulated time.
phase: a part of an I2C transfer from a START or repeated START to the next repeated START or STOP.
turn: a phase that has a complete address byte with its ACK or NACK.
poll: a phase whose address is not acknowledged and that has no data.
`REPLAY`: a list in a firmware module, with the names of the settings that a replay may fill in from the capture.
event: a START, STOP, address, byte, ACK or NACK on the bus, or a word on a UART line.
divergence: a difference between an event of the capture and the corresponding event of the replay.
"""

from __future__ import annotations

from ..core.input_error import InputError


class BadReplay(InputError):
    """A capture cannot be replayed with the given case and options."""
