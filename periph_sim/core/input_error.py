"""Base class of errors that a user's input causes."""

from __future__ import annotations


class InputError(ValueError):
    """An error in the user's input. Its message is one sentence, which the command prints before it exits."""
