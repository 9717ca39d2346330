"""The SPI module: master and slave, FIFOs, loop-back and interrupts (SPRUEU3)."""
