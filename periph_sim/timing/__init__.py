"""Measures, budgets and verdicts; over a recorded run `between`, `periods` and `happened`."""

from __future__ import annotations

from .over_table import Durations, between, happened, periods

__all__ = ["Durations", "between", "happened", "periods"]
