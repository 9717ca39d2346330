"""Replaying captures against firmware.

Capture, Case --> I2cReplay or UartReplay --run--> Report: where the wires first differ from the capture
"""


class BadReplay(ValueError):
    """A capture, or a way to map it, that cannot be replayed; the message is one sentence for the user."""
