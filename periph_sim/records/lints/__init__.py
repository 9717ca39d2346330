"""Lints. Each lint is a function that yields the accesses that violate a rule; it has the decorator `lint.finds`."""
