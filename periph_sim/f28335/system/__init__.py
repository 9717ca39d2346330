"""System control, CPU timers, watchdog and the memory map (SPRUFB0D)."""
