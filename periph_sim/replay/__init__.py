"""Replay of captures against firmware.

Capture, Case --> I2cReplay or UartReplay --run--> Report: the first differences of the wires from the capture
"""


class BadReplay(ValueError):
    """A capture, or a mapping of it, that cannot be replayed; the message is one sentence for the user."""
