"""What the outside asked and cannot have."""

from __future__ import annotations


class OutsideError(ValueError):
    """One sentence for the user: who, what was found, what was expected, the way out."""


class ArbitrationLost(OutsideError):
    """Another controller has won the bus."""
