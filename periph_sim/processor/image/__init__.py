"""Firmware images as programs of a processor: an image goes in; its instructions run in the cycles of the chip."""
