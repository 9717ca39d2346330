"""The figures of docs/schedule.md: a bench's JSON goes in; the page with its rates between its marks comes out.

python -m tests.bench schedule         measures them, and keeps them in build/bench/bench.json
python -m tests.bench.schedule_page    writes them into the page
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import fill
from typing import Any

from .child import ROOT
from .readme import rounded

PAGE, BENCH = ROOT / "docs" / "schedule.md", ROOT / "build" / "bench" / "bench.json"
MARKS = re.compile(
    r"(?<=<!-- rates: python -m tests\.bench\.schedule_page -->\n).*?(?=<!-- end of rates -->)", re.DOTALL
)


def table(told: Mapping[str, Any]) -> str:
    """Markdown: a line for each row of the part `schedule` that has a rate, and the machine behind them."""
    machine, rows = told["machine"], [row for row in told["parts"]["schedule"] if "per_s" in row]
    lines = ["", "| what differs between the scenarios | scenarios per second of CPU time |", "|---|---|"]
    lines += [f"| {row['what']} | {rounded(row['per_s']):,.0f} |" for row in rows]
    busy = f", beside other work (load {machine['load']:.0f})" if machine["load"] >= 1 else ""
    scenarios, rounds = rows[0]["scenarios"], rows[0]["rounds"]
    said = (
        f"{machine['date']}, one core of {machine['processor']}, {machine['python']}, {machine['forms'][0]}{busy}: "
        f"calls of {scenarios:,} scenarios of {rounds} rounds, medians."
    )
    return "\n".join([*lines, "", fill(said, 120, break_on_hyphens=False), "", ""])


def with_table(page: str, told: Mapping[str, Any]) -> str:
    """The page with this table between its marks."""
    if len(MARKS.findall(page)) != 1:
        raise ValueError("docs/schedule.md has no marks of the rates, or several")
    return MARKS.sub(lambda found: table(told), page)


def main(arguments: Sequence[str]) -> None:
    told = json.loads(Path(arguments[0] if arguments else BENCH).read_text("utf-8"))
    PAGE.write_text(with_table(PAGE.read_text("utf-8"), told), "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
