"""Windows built by hand: a Window is made from text that describes the activity of a CPU.

drawn("span model 0 100", "irq SCIRXINTA 20 30")      name, begin, end in ticks; end "-" for an activity that continues
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

from periph_sim.core.records import Kind, Record
from periph_sim.core.time import Timebase
from periph_sim.interfaces.reports.explain.explain import Explained
from periph_sim.interfaces.reports.explain.explain import explain as explain_all
from periph_sim.interfaces.reports.explain.window import Window
from periph_sim.processor.dsp import Dsp
from periph_sim.scene.case.model import Case
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.scene import Scene
from periph_sim.timing.verdict import Verdict
from periph_sim.traces.capture.capture import Capture, Span


def explain(*case_and_verdicts: Any, **names: Any) -> dict[str, Explained]:
    """Return the explanations of worst occurrences by the names of their budgets."""
    return {one.window.verdict.name: one for one in explain_all(*case_and_verdicts, **names)}


def run_and_explain(made: Case, program: Callable[[Dsp], None] | None = None) -> dict[str, Explained]:
    """Run a case and explain its worst occurrences. `program` replaces the firmware of the unit dsp, if it is given."""
    programs = {} if program is None else {"dsp": Firmware("given", lambda dsp, settings: program(dsp), None)}
    scene = Scene(made, programs=programs)
    return explain(made, scene.run().budgets, scene.typical(), programs=programs)


def steps_of(one: Explained) -> list[str]:
    return [step.what for step in one.chain.steps]


KINDS = {"span": Kind.SPAN, "irq": Kind.IRQ, "wait": Kind.WAIT}
TIMEBASE = Timebase(150_000_000)


def drawn(*episodes: str, begin: int = 0, end: int = 100, kept: tuple[Span, ...] = (Span(-50, 150),)) -> Window:
    """Return a window of the unit "dsp". Records from before `kept` are in its `before`."""
    moves: list[tuple[int, Kind, str]] = []
    for text in episodes:
        kind, name, first, last = text.split()
        moves += [(int(tick), KINDS[kind], name) for tick in (first, last) if tick != "-"]
    moves.sort(key=lambda move: move[0])
    made = [Record(n, tick, kind, "dsp", name, 0, "f:1", 0) for n, (tick, kind, name) in enumerate(moves, 1)]
    begun: set[tuple[Kind, str]] = set()
    records = []
    for record in made:
        key = record.kind, record.what
        records.append(record._replace(value=int(key not in begun)))
        begun ^= {key}
    return Window(
        verdict=Verdict("made", "span:model", "us", 1.0, 1.0, 0.0, 1, "pass", 0.0),
        begin=begin,
        end=end,
        drawn=kept[0],
        kept=kept,
        records=tuple(r for r in records if any(span.begin <= r.tick < span.end for span in kept)),
        before=tuple(r for r in records if r.tick < kept[0].begin),
        edges=Capture(Path("made"), Fraction(TIMEBASE.per_second), kept[-1].end, (), sampled=False),
        timebase=TIMEBASE,
        start=0,
    )
