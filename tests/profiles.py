"""Which profile the tests run in: the ordinary one, or that of `make explore`, which has the time for all there is."""

from __future__ import annotations

from hypothesis import settings


def explores() -> bool:
    """True in `make explore`. To be asked as tests are collected, not before."""
    return settings.get_current_profile_name() == "explore"
