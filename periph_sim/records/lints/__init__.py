"""Lints. Each is a function with the decorator `finds` (`lint.py`); it yields the accesses that violate a rule."""
