"""Errors of requests from outside."""

from __future__ import annotations


class OutsideError(ValueError):
    """One sentence for the user: place, what was found, what was expected, remedy."""


class ArbitrationLost(OutsideError):
    """Another controller has won the bus."""
