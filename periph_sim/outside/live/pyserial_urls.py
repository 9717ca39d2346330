"""pyserial is told that `f28335://` URLs are ours. Needs pyserial."""

from __future__ import annotations

import serial

PACKAGE = "periph_sim.outside.live"


def register() -> None:
    """From now on `serial_for_url` knows them."""
    if PACKAGE not in serial.protocol_handler_packages:
        serial.protocol_handler_packages.append(PACKAGE)
