"""Run a session with user code in a separate process, as commands do.

Firmware that ends its process, by `os._exit(0)` for instance, would end the session with status 0: all tests passed.
Here such a session has status 3, pytest's own for an internal error. The process starts before cases are collected, or
before the first test if only tests use runs. A worker of pytest-xdist needs none: its session fails if it ends.
"""

from __future__ import annotations

import pytest

from ...supervisor import NO_VERDICT, Completion, can_fork, split

_completion: Completion | None = None  # of the session running in this process


def begin(config: pytest.Config) -> None:
    """Continue in a child process that this one waits for, unless already done."""
    global _completion
    if _completion is None and can_fork and not hasattr(config, "workerinput"):
        _completion = split("pytest", strict=False)


def end(status: int) -> int:
    """Report a session as complete and return its exit status; 3 instead of 0 if its output may be lost."""
    global _completion
    if _completion is None:
        return status
    if status == 0 and _completion.flaw():
        return NO_VERDICT
    _completion.complete(status)
    _completion = None
    return status
