"""Every numbered rule of the manuals is named by a test, or stands as not modelled with its reason."""

from __future__ import annotations

from tests.rules.coverage import gaps


def test_every_rule_is_named_or_explained():
    assert gaps() == []
