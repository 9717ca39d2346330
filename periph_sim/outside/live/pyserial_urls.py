"""Registration of `f28335://` URLs with pyserial. This module can be imported only if pyserial is installed."""

from __future__ import annotations

import serial

PACKAGE = "periph_sim.outside.live"


def register() -> None:
    """Make pyserial's `serial_for_url` accept `f28335://` URLs."""
    if PACKAGE not in serial.protocol_handler_packages:
        serial.protocol_handler_packages.append(PACKAGE)
