"""Which profile the tests run in: the ordinary one, or that of `make explore`, which has the time for all there is."""

from __future__ import annotations

from hypothesis import settings


def explores() -> bool:
    """True in `make explore`. To be asked as tests are collected, not before."""
    return settings.get_current_profile_name() == "explore"


def examples(in_suite: int) -> int:
    """How many examples of chance a property has: so many in the suite, the same each time; 25 times as many in `make
    explore`.

    To be asked as tests are collected: a number in `@settings` stands against the profile's own.
    """
    return in_suite * 25 if explores() else in_suite
