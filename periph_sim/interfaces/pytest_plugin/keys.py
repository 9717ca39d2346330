"""Keys that the plugin uses in pytest: the name of its ini option, and the stash key of the running test."""

from __future__ import annotations

import pytest

CASES = "periph_sim_cases"
current: pytest.StashKey[pytest.Item] = pytest.StashKey()
