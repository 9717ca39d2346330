"""System control: clocks, gates and the watchdog (SPRUFB0D section 5)."""
