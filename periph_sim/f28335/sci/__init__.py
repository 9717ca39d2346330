"""The SCI module (SPRUFZ5A).

Terms of this package:
SCICLK: the sample clock, with eight periods in a bit. A tick is one of these periods, or its number.
sub-sample: one of the eight samples of a bit, numbered from 1.
bit receiver: the part of the receiver that finds frames in the levels on RXD (`receiver_bits.SciRxBits`).
address frame: a frame with address bit 1 or, in idle-line mode, the first frame after an idle line.
idle time: a high level of about a frame's length that is sent in place of a frame, because TXWAKE was set.
mark: the number that identifies the write of a word in the records of a run (`core.chip.WriteOrigins`).
"""
