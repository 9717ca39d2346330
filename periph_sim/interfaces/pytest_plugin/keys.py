"""Names that the plugin registers in pytest: an ini option, a mark, the current test."""

from __future__ import annotations

import pytest

CASES = "periph_sim_cases"
MARKER = (
    "case(file, *changes, seconds=None, record=False): "
    "the case that fixture case_run runs, with KEY=VALUE changes as for periph-sim run --set"
)
current: pytest.StashKey[pytest.Item] = pytest.StashKey()
