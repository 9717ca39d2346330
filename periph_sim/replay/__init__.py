"""Replay of captures against firmware.

Capture, Case --> I2cReplay or UartReplay --run--> Report: the first differences of the wires from the capture

A session is an I2C capture and a UART capture that are replayed together. A position is a time in a capture: the number
of a sample, or the value of a time stamp.
"""


class BadReplay(ValueError):
    """A capture cannot be replayed with this case and mapping. The message is one sentence for the user."""
