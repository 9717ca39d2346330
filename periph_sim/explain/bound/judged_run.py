"""What bounds are held beside: a case that was run and judged, at whatever level."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from ...scene.case.model import Case
from ...scene.firmware_loader import Firmware
from ...timing.budgets import BudgetJudge


class JudgedRun(Protocol):
    """case, firmware: of which bounds are. stalled: why it ended before its time."""

    @property
    def case(self) -> Case: ...

    @property
    def firmware(self) -> Mapping[str, Firmware]: ...

    @property
    def limits(self) -> Sequence[BudgetJudge]: ...

    @property
    def stalled(self) -> str: ...
