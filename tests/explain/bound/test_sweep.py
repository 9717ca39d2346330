"""Random scenes at random phases: no value is beyond its bound. More: `python -m tests.explain.bound.sweep`."""

from __future__ import annotations

import pytest

from tests.explain.bound.sweep import sweep


@pytest.mark.parametrize("first", [1, *range(101, 1101, 100)])  # but for the first one they are `long`
def test_no_value_of_random_scenes_is_beyond_its_bound(first: int):
    swept = sweep(range(first, first + (10 if first == 1 else 20)))
    assert not swept.beyond
    assert swept.compared > 50 and swept.none < 8
