"""The CPU's interrupt logic and instruction costs, the PIE and the external interrupts (SPRUFB0D, SPRU430F)."""
