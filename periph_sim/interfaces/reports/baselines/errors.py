"""Errors of `check` that the user can correct."""

from __future__ import annotations


class BadCheck(ValueError):
    """Cases or baselines cannot be checked; one sentence per line."""
