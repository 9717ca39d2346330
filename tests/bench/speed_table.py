"""The table of speeds in docs/fidelity.md, made from the JSON file of a bench. docs/bench.json keeps the figures.

    python -m tests.bench.speed_table build/bench/bench.json    keep the figures of that bench, and write the table
    python -m tests.bench.speed_table                           write the table of the kept figures

build/bench/bench.json --figures--> docs/bench.json --table--> docs/fidelity.md, between its marks
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import fill
from typing import Any

from periph_sim.form import COMPILED, INTERPRETED

from .child import ROOT
from .levels import PLAIN
from .peers import BUS_OF_OTHERS
from .start import COMMANDS, SHORT
from .targets import BYTES, DECLARED, Read, figure, recorded, speed

PAGE, KEPT = ROOT / "docs" / "fidelity.md", ROOT / "docs" / "bench.json"
MARKS = re.compile(r"(?<=<!-- speed: python -m tests\.bench\.speed_table -->\n).*?(?=<!-- end of speed -->)", re.DOTALL)
RUN = next(what for what in COMMANDS if "imu_hil" in what)

# The name in the table, the function that reads its figure from a bench, and the format.
ROWS: tuple[tuple[str, Read, str], ...] = (
    ("`imu_hil` with all its budgets", speed("imu_hil"), "rate"),
    ('`imu_hil`, `arithmetic = "bytes"`, no budgets', speed(BYTES), "rate"),
    ("that case edge by edge", speed(BYTES, PLAIN), "rate"),
    ("`responder`", speed("responder"), "rate"),
    ("`responder` edge by edge", speed("responder", PLAIN), "rate"),
    ("`responder`, its waits declared", speed(DECLARED), "rate"),
    ("`imu_hil` with its flags recorded", recorded("flags, kept"), "factor"),
    ("`imu_hil` recorded as `.psr`", recorded(".psr"), "factor"),
    ("10 ms of `imu_hil` from Python, set-up included", figure("start", "cpu_s", what=SHORT), "time"),
    ("`periph-sim run`, 20 ms of `imu_hil`, all included", figure("start", "cpu_s", what=RUN), "time"),
)


def figures(text: Mapping[str, Any]) -> dict[str, Any]:
    """Return the kept part of a bench: machine, figures of the table, and those of another simulator."""
    parts = text["parts"]
    rows = [
        {"what": what, "shown": shown} | {form: rounded(read(parts, form)) for form in (COMPILED, INTERPRETED)}
        for what, read, shown in ROWS
    ]
    others = next((row for row in parts.get("peers", ()) if row["what"] == BUS_OF_OTHERS), {})
    kept = {"what": BUS_OF_OTHERS, "per_s": rounded(others.get("per_s")), "lacks": others.get("lacks", "")}
    return {"machine": text["machine"], "rows": rows, "others": kept}


def rounded(figure: float | None) -> float | None:
    """Round to three digits, because the fourth changes from hour to hour."""
    return None if figure is None else float(f"{figure:.3g}")


def table(kept: Mapping[str, Any]) -> str:
    """Return the table as Markdown."""
    machine = kept["machine"]
    lines = ["", "| what runs | compiled | interpreted |", "|---|---|---|"]
    lines += [
        f"| {row['what']} | {cell_of(row[COMPILED], row['shown'])} | {cell_of(row[INTERPRETED], row['shown'])} |"
        for row in kept["rows"]
    ]
    busy = f", beside other work (load {machine['load']:.0f})" if machine["load"] >= 1 else ""
    text = (
        f"{machine['date']}, one core of {machine['processor']}, {machine['python']}{busy}: "
        "I2C bytes per second of CPU time, medians. `make bench` measures these, all cases, and growth."
    )
    if kept["others"]["per_s"] is not None:
        rate, of = f"{kept['others']['per_s']:,.0f}", kept["others"]["lacks"].partition(";")[0]
        text += f" Beside it cocotb 2 with Icarus Verilog and cocotbext-i2c: {rate} bytes/s of {of}."
    lines += ["", fill(text, 120, break_on_hyphens=False)]
    return "\n".join([*lines, "", ""])


def cell_of(figure: float | None, shown: str) -> str:
    if figure is None:
        return "-"
    if shown == "rate":
        return f"{figure:,.0f} bytes/s"
    return f"{figure:.2f} times as long" if shown == "factor" else f"{figure * 1e3:.3g} ms"


def with_table(page: str, kept: Mapping[str, Any]) -> str:
    """Return the page with this table between its marks. Raise ValueError if it has no marks or several."""
    if len(MARKS.findall(page)) != 1:
        raise ValueError("docs/fidelity.md has no marks of the speed table, or several")
    return MARKS.sub(lambda found: table(kept), page)


def main(arguments: Sequence[str]) -> None:
    if arguments:
        text = json.loads(Path(arguments[0]).read_text("utf-8"))
        KEPT.write_text(json.dumps(figures(text), indent=1) + "\n", "utf-8")
    PAGE.write_text(with_table(PAGE.read_text("utf-8"), json.loads(KEPT.read_text("utf-8"))), "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
