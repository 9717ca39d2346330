"""Lints, each a function with `finds` that yields the accesses at fault (`lint.py`)."""
