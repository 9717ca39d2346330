"""The worst occurrence of each budget: its surroundings, its causes, and its picture.

timing      verdict: the budget, its worst value and its instant
  |
window      one more run, recorded: all records around that instant        (`windows`)
  |
evidence    the same by subject: phases on the bus, accesses, flags, CPU activity   (`Evidence`)
  |
findings    the records at the two ends, found by what the measure looks at (`Ends`); what those around an instant show
  |
explain     the steps, with the causes of both ends, and the parts: the time from end to end by place: bus, party that
            holds SCL, hardware, firmware
  |
chain       the explanation as data, as text and as JSON                            (`Chain`)
picture, reports/html    pictures of it

No module here knows a kind of budget: a new measure is explained by the records that it looks at. Two expectations are
in the case and not in a record: the text of a reply and the edges of a watched wire.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....core.registered import lazy_names

if TYPE_CHECKING:
    from .window import Window, windows, windows_of_table

__all__ = ["Window", "windows", "windows_of_table"]

__getattr__ = lazy_names(__name__, {"window": ("Window", "windows", "windows_of_table")})
