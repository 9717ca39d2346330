"""The SPI module: master and slave, FIFOs, loop-back and interrupts (SPRUEU3).

Terms of this package:
character: the 1 to 16 bits that one transfer of SPIDAT sends and receives.
leading edge, trailing edge: the change of SPICLK from its idle to its active level, and back.
to latch: to sample the data input at an edge of SPICLK and shift the bit into SPIDAT.
"""
