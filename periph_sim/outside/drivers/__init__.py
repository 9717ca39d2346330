"""Substitutes for hardware that sensor drivers use: objects and files connected to a session."""

from __future__ import annotations

from .busio_i2c import I2C
from .i2c_dev import i2c_dev
from .i2cdriver_port import I2cDriverPort

__all__ = ["I2C", "I2cDriverPort", "i2c_dev"]
