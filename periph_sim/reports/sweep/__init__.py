"""Sweeps: one case run many times with other values; a column for each figure comes out.

case, {key: values} --plan--> changes of each run --workers--> Row each --columns--> Sweep

Rows stand in the order in which the changes do, whoever runs them and however many at a time.
"""

from __future__ import annotations

from .columns import BudgetColumns, Sweep
from .sweep import SweepStopped, sweep

__all__ = ["BudgetColumns", "Sweep", "SweepStopped", "sweep"]
