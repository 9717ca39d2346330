"""Timer of the SPI master: computes the cycle of an event from the number of LSPCLK edges before it.

    SYSCLKOUT --/divider--> LSPCLK: an edge in each cycle n with n % divider == phase --> k-th edge from now = event

Source: TI SPRUEU3 section 1.4.3; SPRUFB0D section 5.1 for LSPCLK.
"""

from __future__ import annotations

from ...core.chip import NEVER
from ...core.state import State


class LspclkTimer:
    """Timer that counts LSPCLK edges to one event. Initially its clock is stopped.

    at: cycle of the event; NEVER if there is no event, or while the clock is stopped.
    divider: period of LSPCLK in SYSCLKOUT cycles.
    """

    STATE = State("running divider _phase _left", cycles="at")

    def __init__(self) -> None:
        self.running = False
        self.at = NEVER
        self.divider = 4
        self._phase = 0
        self._left = 0  # while stopped: number of LSPCLK edges to the event; 0 without an event

    def plan(self, now: int, edges: int) -> None:
        """Schedule the event for the `edges`-th LSPCLK edge after `now`."""
        self._left = edges
        self.at = self._edge_after(now) + (edges - 1) * self.divider if self.running else NEVER

    def cancel(self) -> None:
        """Cancel the event."""
        self._left = 0
        self.at = NEVER

    def edges_to_multiple(self, now: int, edges: int) -> int:
        """Return the number of LSPCLK edges from `now` until the next edge whose index is a multiple of `edges`.

        This edge is counted, but an edge at `now` is not, so the result is 1 to `edges`. The edge in the cycle `phase`
        (see `set_lspclk`) has the index 0.
        """
        return edges - (now - self._phase) // self.divider % edges

    def stop(self, now: int) -> None:
        """Stop the clock. The number of LSPCLK edges that are left to the event stays the same."""
        if self.running:
            self.running = False
            if self.at < NEVER:
                self._left = 1 + (self.at - self._edge_after(now)) // self.divider
                self.at = NEVER

    def start(self, now: int) -> None:
        """Start the clock. The event comes after the number of LSPCLK edges that was left when the clock stopped."""
        if not self.running:
            self.running = True
            if self._left:
                self.plan(now, self._left)

    def set_lspclk(self, now: int, divider: int, phase: int) -> None:
        """Set the period of LSPCLK to `divider` cycles, with an edge in each cycle n with n % divider == phase."""
        was_running = self.running
        self.stop(now)
        self.divider, self._phase = divider, phase % divider
        if was_running:
            self.start(now)

    def _edge_after(self, now: int) -> int:
        return now + self.divider - (now - self._phase) % self.divider
