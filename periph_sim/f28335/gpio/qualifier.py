"""The sampling qualifier of one pin, which derives the qualified level and its changes from the synchronised level.

    level --> sample every `period` cycles --> `samples` equal ones in a row --> qualified

    period 2, 3 samples   sample     | | | | | |
                          level    ___/~~~~~~~~~
                          qualified_________/~~~

Evaluation is lazy: samples are not taken one by one; a call counts those that fall into
the time since the last one. `due` is the cycle at which the output will change if the
level stays.

Silicon simply counts equal samples, and the erratum's pulse follows from that: a pulse of
n·(m - 1) + 1 cycles passes in one of n phases, although n·m was intended.

Source: SPRUFB0D section 6.4.3, Tables 42 to 45, Figure 46; SPRZ272N section 3.2.

Chosen:
- The output changes in the cycle of the last of the equal samples.
- A change of the sampling period restarts the prescaler; a change between three and six
  samples keeps the samples already taken.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.chip import NEVER
from ...core.state import State

DEPTH = 6  # the maximum number of samples that QSEL can require


@final
class Qualifier:
    """Qualifier of one pin.

    level: the initial level, as if sampled for a long time.
    origin: a cycle in which the prescaler sampled.
    """

    STATE = State("level qualified _period _samples _sampled _run", cycles="due _origin _done", made=True)

    def __init__(self, now: int, level: int, period: int, samples: int, origin: int) -> None:
        self.level = level  # from the synchroniser
        self.qualified = level
        self.due = NEVER  # when `qualified` will change if the level stays
        self._period = period
        self._samples = samples
        self._origin = origin
        self._sampled = level  # the last sample
        self._run = DEPTH  # the number of equal samples at the end
        self._done = now  # samples up to and including this cycle are taken

    def edge(self, now: int, level: int) -> None:
        """Set the synchronised level from cycle `now` on (a sample in that cycle sees it)."""
        self.advance(now - 1)
        self.level = level
        self._plan()

    def advance(self, now: int) -> None:
        """Take all samples up to and including cycle `now`."""
        if now <= self._done:
            return
        origin, period = self._origin, self._period
        taken = (now - origin) // period - (self._done - origin) // period
        self._done = now
        if not taken:
            return
        if self._sampled != self.level:
            self._sampled = self.level
            self._run = 0
        self._run = min(self._run + taken, DEPTH)
        if self._run >= self._samples:
            self.qualified = self._sampled
            self.due = NEVER

    def configure(self, now: int, period: int, samples: int, origin: int) -> None:
        """Set a new period, number of samples and phase from cycle `now` on."""
        self.advance(now)
        self._period, self._samples, self._origin = period, samples, origin
        self._plan()

    def _plan(self) -> None:
        if self.level == self.qualified:
            self.due = NEVER
            return
        have = self._run if self._sampled == self.level else 0
        lacking = max(self._samples - have, 1)
        self.due = self._origin + ((self._done - self._origin) // self._period + lacking) * self._period
