"""The SCI module (SPRUFZ5A).

Terms of this package:
SCICLK: the sample clock, with eight periods in a bit. Ticks are the numbers of its periods.
idle time: a high level of about a frame's length that is sent in place of a frame, because TXWAKE was set.
"""
