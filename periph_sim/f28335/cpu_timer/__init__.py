"""The CPU timers (SPRUFB0D section 5.5)."""
