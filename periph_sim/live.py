"""`import periph_sim.live`: from then on pyserial's `serial_for_url` knows `f28335://CASE?port=scia&pace=1`."""

from __future__ import annotations

try:
    from .outside.live.pyserial_urls import PACKAGE, register
except ImportError:
    raise ImportError("periph_sim.live needs pyserial: pip install 'periph-sim[live]'") from None

__all__ = ["PACKAGE"]

register()
