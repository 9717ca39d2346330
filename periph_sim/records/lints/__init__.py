"""Lints. Each is a function with the decorator `finds` from `lint.py` that yields the accesses which violate a rule."""
