"""Tests. Failed comparisons of diagrams are shown as in the modules of tests."""

import pytest

pytest.register_assert_rewrite("tests.waves")
