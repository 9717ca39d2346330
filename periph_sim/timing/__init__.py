"""Measures, budgets and verdicts; over a recorded run `between`, `periods`, `happened`, `races` and `lost_flags`."""

from __future__ import annotations

from .measures.over_table import Durations, between, happened, periods
from .measures.race import Distances, lost_flags, races

__all__ = ["Distances", "Durations", "between", "happened", "lost_flags", "periods", "races"]
