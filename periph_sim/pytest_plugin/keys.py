"""Under which names pytest keeps what is the plugin's: an ini option, a mark, the test that runs now."""

from __future__ import annotations

import pytest

CASES = "periph_sim_cases"
MARKER = (
    "case(file, *changes, seconds=None, record=False): "
    "the case that fixture case_run runs, with KEY=VALUE changes as of periph-sim run --set"
)
current: pytest.StashKey[pytest.Item] = pytest.StashKey()
