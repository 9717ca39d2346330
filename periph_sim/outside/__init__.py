"""Connection of a case with external parties, by a session without input and output of its own.

simulator, serial port, driver --apply--> Session --advance--> changes of our pins, with their ticks
                                             `--log--> replay --> the same run once more
"""

from __future__ import annotations

from .door import Change
from .errors import OutsideError
from .replay import replay
from .session import Session

__all__ = ["Change", "OutsideError", "Session", "replay"]
