"""Importing this module registers URLs such as `f28335://CASE?port=scia&pace=1` for pyserial's `serial_for_url`."""

from __future__ import annotations

try:
    from .outside.live.pyserial_urls import PACKAGE, register
except ImportError:
    raise ImportError("periph_sim.live needs pyserial: pip install 'periph-sim[live]'") from None

__all__ = ["PACKAGE"]

register()
