"""Errors of requests from outside."""

from __future__ import annotations


class OutsideError(ValueError):
    """A request from outside is invalid or cannot be executed.

    The message is a sentence with the place, what was found, what was expected, and a remedy.
    """


class ArbitrationLost(OutsideError):
    """Another controller has won the bus."""
