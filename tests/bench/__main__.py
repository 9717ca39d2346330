"""`make bench`: how fast it runs here, part by part, into one JSON and one plot. Nothing is asserted on time.

python -m tests.bench [--long] [--repeat 3] [--json build/bench/bench.json] [--plot build/bench/bench.svg] [PART ...]

    machine, date --.
    each part: rows -+--> {"machine": ..., "parts": {PART: [rows]}} --> JSON, plot, a line a row as it comes
    targets --------'

CPU time of one core, medians; parts that are not asked for keep the rows of a JSON that is there, if it is of the same
machine and day. python -m tests.bench.speed_table puts its figures into docs/fidelity.md.
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
    parser = argparse.ArgumentParser(prog="python -m tests.bench", description="How fast it runs here.")
    parser.add_argument("--long", action="store_true", help="growth up to an hour of scene, not a minute")
    parser.add_argument("--repeat", type=int, default=3, help="runs of which the median is taken")
    parser.add_argument("--json", type=Path, default=ROOT / "build" / "bench" / "bench.json")
    parser.add_argument("--plot", type=Path, default=ROOT / "build" / "bench" / "bench.svg")
    parser.add_argument("parts", nargs="*", metavar="PART", help="levels, recorded, start, peers, ...; all without")
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
    told: dict[str, Any] = {"schema": SCHEMA, "machine": machine(which), "parts": kept(given.json, machine(which))}
    for name in given.parts or known:
        rows, line = known[name]
        began = perf_counter()
        print(f"\n{name}", flush=True)
        told["parts"][name] = []
        for row in rows():
            print(f"  {line(row)}", flush=True)
            told["parts"][name].append(row)
        print(f"  ({perf_counter() - began:.0f} s)", flush=True)
        written(given.json, told)
    told["targets"] = list(targets.rows(told["parts"]))
    print("\ntargets")
    for row in told["targets"]:
        print(f"  {targets.line(row)}")
    written(given.json, told)
    given.plot.parent.mkdir(parents=True, exist_ok=True)
    if told["parts"].get("levels"):
        levels.plot(told["parts"]["levels"], given.plot)


def kept(path: Path, here: dict[str, Any]) -> dict[str, Any]:
    """The parts of a JSON that is there already, of this machine, day and forms."""
    try:
        told = json.loads(path.read_text("utf-8"))
        same = all(told["machine"][key] == here[key] for key in ("date", "processor", "python", "forms", "periph_sim"))
        return dict(told["parts"]) if same else {}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def written(path: Path, told: dict[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(told, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
