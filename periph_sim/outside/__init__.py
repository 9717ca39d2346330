"""Sessions: external code steps a case and moves some of its lines. A session has no input or output of its own.

simulator, serial port, driver --apply--> Session --advance--> changes of our pins, with their ticks
                                             `--log--> replay --> the same run again

In this package, "our" pins are those of the case, and "the outside" is the code that uses the session.
"""

from __future__ import annotations

from .errors import OutsideError
from .replay import replay
from .session import Change, Session

__all__ = ["Change", "OutsideError", "Session", "replay"]
