"""Measures, budgets and verdicts; over a recorded run `between`, `periods`, `happened`, `races` and `lost_flags`."""

from __future__ import annotations

from .over_table import Durations, between, happened, periods
from .race_measures import Distances, lost_flags, races

__all__ = ["Distances", "Durations", "between", "happened", "lost_flags", "periods", "races"]
