"""Profile of an image's program: time by function, flame graph and line coverage (lcov)."""
