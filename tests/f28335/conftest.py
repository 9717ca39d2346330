"""Checks that a test of an open question used its option in a rig that it kept."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from .open_questions import kept


@pytest.fixture(autouse=True)
def the_runs_list_their_option() -> Iterator[None]:
    kept.clear()
    yield
    for option, rigs in kept.items():
        assert option in set().union(*(rig.chip.touched for rig in rigs))
