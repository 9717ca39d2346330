"""What `check` refuses: a sentence or several go in, an error the user is to blame for comes out."""

from __future__ import annotations


class BadCheck(ValueError):
    """Cases or baselines that cannot be checked; one sentence each, a line each."""
