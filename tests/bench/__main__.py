"""`make bench`: speed on this machine, part by part, as one JSON file and one plot. No time is asserted.

python -m tests.bench [--long] [--repeat 3] [--json build/bench/bench.json] [--plot build/bench/bench.svg] [PART ...]

    machine, date --.
    each part: rows -+--> {"machine": ..., "parts": {PART: [rows]}} --> JSON, plot, a printed line per row
    targets --------'

Figures are medians of CPU time on one core. Parts that are not requested keep their rows of an existing JSON file from
the same machine and day. python -m tests.bench.speed_table writes the figures to docs/fidelity.md.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterable
from pathlib import Path
from time import perf_counter
from typing import Any

from periph_sim import form

from . import decode, growth, images, levels, nothing, numeric, peers, recorded, start, targets
from .child import ROOT, forms
from .machine import machine

SCHEMA = 1


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.bench", description="Measure the speed on this machine.")
    parser.add_argument("--long", action="store_true", help="measure growth up to an hour of scene instead of a minute")
    parser.add_argument("--repeat", type=int, default=3, help="number of runs, whose median is used")
    parser.add_argument("--json", type=Path, default=ROOT / "build" / "bench" / "bench.json")
    parser.add_argument("--plot", type=Path, default=ROOT / "build" / "bench" / "bench.svg")
    parser.add_argument("parts", nargs="*", metavar="PART", help="levels, recorded, start, peers, ...; default: all")
    given = parser.parse_args()
    which, repeat = forms(), given.repeat
    if len(which) == 1:
        print(f"interpreted only: {form.note or 'the core is not compiled; `make core` does'}")
    known: dict[str, tuple[Callable[[], Iterable[dict[str, Any]]], Callable[[dict[str, Any]], str]]] = {
        "levels": (lambda: levels.rows(which, repeat), levels.line),
        "recorded": (lambda: recorded.rows(which, repeat), recorded.line),
        "start": (lambda: start.rows(which, repeat), start.line),
        "peers": (lambda: peers.rows(which), peers.line),
        "growth": (lambda: growth.rows(which, given.long), growth.line),
        "nothing": (lambda: nothing.rows(which), nothing.line),
        "numeric": (numeric.rows, numeric.line),
        "decode": (lambda: decode.rows(repeat), decode.line),
        "images": (lambda: images.rows(which, repeat), images.line),
    }
    if unknown := set(given.parts) - set(known):
        parser.error(f"there is no part {', '.join(sorted(unknown))}; there are {', '.join(known)}")
    bench: dict[str, Any] = {"schema": SCHEMA, "machine": machine(which), "parts": kept(given.json, machine(which))}
    for name in given.parts or known:
        rows, line = known[name]
        began = perf_counter()
        print(f"\n{name}", flush=True)
        bench["parts"][name] = []
        for row in rows():
            print(f"  {line(row)}", flush=True)
            bench["parts"][name].append(row)
        print(f"  ({perf_counter() - began:.0f} s)", flush=True)
        write_json(given.json, bench)
    bench["targets"] = list(targets.rows(bench["parts"]))
    print("\ntargets")
    for row in bench["targets"]:
        print(f"  {targets.line(row)}")
    write_json(given.json, bench)
    given.plot.parent.mkdir(parents=True, exist_ok=True)
    if bench["parts"].get("levels"):
        levels.plot(bench["parts"]["levels"], given.plot)


def kept(path: Path, here: dict[str, Any]) -> dict[str, Any]:
    """Return the parts of an existing JSON file of the same machine, day and forms, or {}."""
    try:
        bench = json.loads(path.read_text("utf-8"))
        same = all(bench["machine"][key] == here[key] for key in ("date", "processor", "python", "forms", "periph_sim"))
        return dict(bench["parts"]) if same else {}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def write_json(path: Path, bench: dict[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(bench, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
