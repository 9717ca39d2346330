"""Fixtures of the tests of commands."""

from tests.interfaces.commands.conftest import desk, periph_sim  # noqa: F401
