"""The worst occurrence of each budget: its surroundings, its causes, and its picture.

timing      verdict: the budget, its worst value and its instant
  |
window      one more run, recorded: all records around that instant        (`windows`)
  |
evidence    the same by subject: phases on the bus, accesses, flags, CPU activity   (`Evidence`)
  |
bus_chain, host_chain, event_chain   the steps to it, by measure  (`Chain`)
  |
text_report, picture; reports/html   for people; `Chain` as JSON for programs
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core.lazy_names import lazy_names

if TYPE_CHECKING:
    from .window import Window, windows, windows_of_table

__all__ = ["Window", "windows", "windows_of_table"]

__getattr__ = lazy_names(__name__, {"window": ("Window", "windows", "windows_of_table")})
