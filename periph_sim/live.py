"""`import periph_sim.live`: from then on pyserial's `serial_for_url` knows `f28335://CASE?port=scia&pace=1`."""

from __future__ import annotations

try:
    import serial
except ImportError:
    raise ImportError("periph_sim.live needs pyserial: pip install 'periph-sim[live]'") from None

PACKAGE = "periph_sim.outside.live"

if PACKAGE not in serial.protocol_handler_packages:
    serial.protocol_handler_packages.append(PACKAGE)
