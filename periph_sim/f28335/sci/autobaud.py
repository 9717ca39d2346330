"""SCI autobaud: recognizes the character 'A' or 'a' from edges on RXD and measures the length of its bits.

    'A' = 0x41    start 1 0 0 0 0 0 1 0 stop      edges at bits 0 1 2 7 8 9
    'a' = 0x61    start 1 0 0 0 0 1 1 0 stop      edges at bits 0 1 2 6 8 9

Chosen, where the manual is silent:
- The time of nine bits, from the fall of the start bit to the rise of the stop bit, is measured in LSPCLK periods. Each
  edge in between must be within an eighth of a bit of its nominal position.
- The character is accepted when RXD has been high for 7/8 of its stop bit. Any other character is lost.
- While the detector waits for the character, the bit receiver is off. At a wrong rate it would receive breaks and
  errors.

Source: TI SPRUFZ5A section 1.2.10.3, table 2-11.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.chip import NEVER
from ...core.state import State

PLACES = {0x41: (0, 1, 2, 7, 8, 9), 0x61: (0, 1, 2, 6, 8, 9)}


@final
class SciAutobaud:
    """Autobaud detector.

    due: the cycle at which `character` is accepted if the line stays high until then; NEVER if none was recognized.
    """

    STATE = State("armed character nine_bits", cycles="due _edges")

    def __init__(self) -> None:
        self.armed = False
        self.due = NEVER
        self.character = 0
        self.nine_bits = 0  # cycles from the first fall to the start of the stop bit
        self._edges: list[int] = []  # cycles of the latest falls and rises, beginning with a fall

    def arm(self, on: bool) -> None:
        if on != self.armed:
            self.armed = on
            self.due = NEVER
            self._edges.clear()

    def edge(self, now: int, level: int) -> None:
        """Set the level of RXD from cycle `now` on. A second edge in one cycle cancels the first."""
        edges = self._edges
        self.due = NEVER
        if edges and edges[-1] == now:
            edges.pop()
        elif edges or not level:
            if len(edges) == 8:
                del edges[:2]
            edges.append(now)
        if len(edges) >= 6 and len(edges) % 2 == 0:
            self._compare(edges[-6:])

    def brr(self, divider: int, phase: int, nearest: bool) -> int:
        """Return the baud divider, 1 to 65535, for the measured length: rounded if `nearest` is True, else truncated.

        divider, phase: those of LSPCLK, as in `SciClock.set_lspclk`.
        """
        last = self._edges[-1]
        first = last - self.nine_bits
        lspclks = (last - phase) // divider - (first - phase) // divider
        steps = (lspclks + 36) // 72 if nearest else lspclks // 72
        return min(max(steps - 1, 1), 0xFFFF)

    def _compare(self, edges: list[int]) -> None:
        first, last = edges[0], edges[5]
        total = last - first
        for character, places in PLACES.items():
            for edge, place in zip(edges, places, strict=True):
                if 8 * abs(9 * (edge - first) - place * total) > total:
                    break
            else:
                self.character = character
                self.nine_bits = total
                self.due = last + total * 7 // 72
                return
