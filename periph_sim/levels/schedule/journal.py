"""What happened in a run of one scenario, in order: the arithmetic tells it; transfers and runs of the models come out.

Kept where one scenario is run as a case: thousands of scenarios have no use for it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from ...core.chip import NEVER


@dataclass(frozen=True)
class Made:
    """A request of a chip, in ticks. frame: that its chips show, -1 where none came yet. stop: NEVER where SCL is held.

    let_go, rise, landed: of each byte, SCL let go by the controller, SCL's rise for its first bit, the write of
    I2CDXR; all empty where nobody acknowledged. again: the repeated START. held: how long SCL was held, at the most.
    """

    chip: int
    start: int
    stop: int
    frame: int = -1
    again: int = 0
    held: int = 0
    let_go: tuple[int, ...] = ()
    rise: tuple[int, ...] = ()
    landed: tuple[int, ...] = ()

    @property
    def acked(self) -> bool:
        return bool(self.let_go)

    @property
    def hung(self) -> bool:
        """SCL is held for ever from the first `let_go` on."""
        return self.acked and self.stop == NEVER


@dataclass
class Journal:
    """made: requests in the order of their STARTs. models: begin and end of each run, in ticks."""

    made: list[Made] = field(default_factory=list)
    models: list[tuple[int, int]] = field(default_factory=list)
