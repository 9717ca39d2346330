"""A project in which the plugin is tested."""

from __future__ import annotations

import pytest

from .project import INI, SMALL


@pytest.fixture
def project(pytester: pytest.Pytester) -> pytest.Pytester:
    """A folder with one case, timing/small.toml, collected as tests."""
    pytester.makefile(".ini", pytest=INI)
    pytester.mkdir("timing").joinpath("small.toml").write_text(SMALL)
    return pytester
