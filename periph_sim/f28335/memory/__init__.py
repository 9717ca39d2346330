"""The address space: memory, peripheral frames, and the names of all registers (SPRS439M, SPRUFB0D)."""
