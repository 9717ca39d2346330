"""Errors of requests from outside."""

from __future__ import annotations


class OutsideError(ValueError):
    """A request from outside is invalid or cannot be executed.

    The message is a sentence that says what is wrong, and normally what was expected or how to fix it.
    """


class ArbitrationLost(OutsideError):
    """Another controller has won the bus."""
