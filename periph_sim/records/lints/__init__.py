"""Lints. Each lint is a function with the decorator `lint.finds` that yields the violations of a rule."""
