"""The worst occurrence of each budget: what there was around it, why it was so long, and its picture.

case, verdicts --window--> Window: all records around the worst occurrence, from one more run
"""

from __future__ import annotations

from .window import Window, windows, windows_of_table

__all__ = ["Window", "windows", "windows_of_table"]
