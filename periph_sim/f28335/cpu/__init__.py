"""The CPU's interrupt logic and the costs of its instructions and of compiled code (SPRU430F)."""
