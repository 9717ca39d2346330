"""Replay of captures against firmware.

Capture, Case --> I2cReplay or UartReplay --run--> Report: the first differences of the wires from the capture

Terms of this package:

capture: the edges of wires that a logic analyser has recorded.
unit: a simulated DSP. The firmware of a unit takes the place of a device in the capture, as target or as controller.
session: an I2C capture and a UART capture that are replayed together.
position: a time in a capture, which is the number of a sample or the value of a time stamp.
turn: a part of an I2C transfer that begins with a START or repeated START and an address.
player: the agent that drives the captured edges on the wires.
event: a START, STOP, address, byte, ACK or NACK on the bus, or a word on a UART line.
divergence: a difference between an event of the capture and the corresponding event of the replay.
"""


class BadReplay(ValueError):
    """A capture cannot be replayed with this case and mapping. The message is one sentence for the user."""
