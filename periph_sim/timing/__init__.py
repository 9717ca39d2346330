"""Measures, budgets and verdicts. For recorded runs: `between`, `periods`, `happened`, `races` and `lost_flags`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core.registered import lazy_names

if TYPE_CHECKING:
    from .measures.over_table import Durations, between, happened, periods
    from .measures.race import Distances, lost_flags, races

__all__ = ["Distances", "Durations", "between", "happened", "lost_flags", "periods", "races"]

__getattr__ = lazy_names(
    __name__,
    {
        "measures.over_table": ("Durations", "between", "happened", "periods"),
        "measures.race": ("Distances", "lost_flags", "races"),
    },
)
