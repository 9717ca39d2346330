"""The table of docs/costs.md has the measured cycles."""

from __future__ import annotations

import re

from tests.docs.pages import ROOT

PAGE = (ROOT / "docs" / "costs.md").read_text(encoding="utf-8")
CYCLE_NS = 10  # a cycle of the case `costs`


def test_the_table_has_the_measured_cycles():
    measured = re.findall(
        r"^ (\S.*?) {2,}(\d\.\d{3}) us +1 us .* seen$", PAGE.split("sed -n 3,19p")[1].split("```")[0], re.M
    )
    table = re.findall(r"^\| ([^|]+) \| (\d+) \| ", PAGE, re.M)
    assert [(name, round(float(us) * 1000) // CYCLE_NS) for name, us in measured] == [(n, int(c)) for n, c in table]
    assert len(table) == 15
