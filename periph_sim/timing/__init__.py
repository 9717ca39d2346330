"""Measures, budgets and verdicts. For recorded runs: `between`, `periods`, `happened`, `races` and `lost_flags`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core.registered import lazy_names

if TYPE_CHECKING:
    from .measures.over_table import Distances, Durations, between, happened, lost_flags, periods, races

__all__ = ["Distances", "Durations", "between", "happened", "lost_flags", "periods", "races"]

__getattr__ = lazy_names(__name__, {"measures.over_table": tuple(__all__)})
