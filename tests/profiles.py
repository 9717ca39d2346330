"""The Hypothesis profile of the tests: the ordinary one, or that of `make explore`, which runs many more examples."""

from __future__ import annotations

from hypothesis import settings


def explores() -> bool:
    """True in `make explore`. Call it while tests are collected, not before."""
    return settings.get_current_profile_name() == "explore"


def examples(in_suite: int) -> int:
    """Return the number of random examples of a property: `in_suite` in the suite, the same each time, and 25 times as
    many in `make explore`.

    Call it while tests are collected, because a number in `@settings` overrides that of the profile.
    """
    return in_suite * 25 if explores() else in_suite
