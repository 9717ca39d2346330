"""Names that the plugin registers in pytest: an option of its settings, and the test that is running."""

from __future__ import annotations

import pytest

CASES = "periph_sim_cases"
current: pytest.StashKey[pytest.Item] = pytest.StashKey()
