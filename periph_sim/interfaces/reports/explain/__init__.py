"""Explanation of the worst occurrence of each budget: the records around it, its causes, and a picture.

timing      verdict: the budget, its worst value and its instant
  |
window      a second run, recorded: all records around that instant                 (`windows`)
  |
evidence    queries of these records: phases on the bus, accesses, flags, CPU activity   (`Evidence`)
  |
findings    the records at both ends of the occurrence (`Ends`), and findings from the records around an instant
  |
explain     steps: events in order of time, with the causes of both ends
            parts: the time between the ends, divided into that of the bus, of parties that hold SCL, of hardware, and
                   of firmware
  |
chain       the explanation as data, as text and as JSON                            (`Chain`)
picture, reports/html    pictures of the occurrence

An explanation is made from the records that a measure uses. Therefore, new measures of the same kinds of records need
no code here. Two expectations come from the case and not from a record: the text of a reply and the edges of a watched
wire.

Terms of this package:

phase: the part of an I2C transfer from a START or repeated START to the next START or STOP.
stretch: a time in which a CPU or the bus has one activity (`Stretch`). A stretch of SCL is a longer low time.
place: a location in the firmware.
thing: the last event of a measure, such as "refused".
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....core.registered import lazy_names

if TYPE_CHECKING:
    from .window import Window, windows, windows_of_table

__all__ = ["Window", "windows", "windows_of_table"]

__getattr__ = lazy_names(__name__, {"window": tuple(__all__)})
