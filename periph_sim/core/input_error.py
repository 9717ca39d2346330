"""Base class of errors that a user's input causes."""

from __future__ import annotations


class InputError(ValueError):
    """Bad input. The message is one sentence for the user, with which commands end."""
