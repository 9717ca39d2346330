"""Random scenes at random phases: no value is beyond its bound. More: `make explore`, or the command of `sweep`."""

from __future__ import annotations

import pytest

from tests.explain.bound.sweep import sweep
from tests.profiles import explores

FIRST = [1, *range(101, 1101, 100)] if explores() else [1, 101]


@pytest.mark.long
@pytest.mark.parametrize("first", FIRST)
def test_no_value_of_random_scenes_is_beyond_its_bound(first: int):
    swept = sweep(range(first, first + (10 if first == 1 else 20)))
    assert not swept.beyond
    assert swept.compared > 50 and swept.none < 8
