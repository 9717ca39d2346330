"""Measures, budgets and verdicts.

Over a recorded run: `between`, `periods`, `happened` in `measures.over_table`; `races`, `lost_flags` in `measures.race`.
"""
