"""Firmware images as programs of a processor: instructions are executed in the cycles that the chip would need."""
