"""The external interrupts (SPRUFB0D section 8.6)."""
