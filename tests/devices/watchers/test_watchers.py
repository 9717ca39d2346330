"""Watchers of wires: settings, a timing diagram of the wire, and the verdict.

__~~~__~     a character is 100 us, low or high; this wire rises at 200 us, falls at 500 us, rises at 700 us
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from periph_sim.devices.watchers import WatchContext, edges
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase, Case
from periph_sim.scene.scene import Scene
from periph_sim.timing.verdict import Verdict

CHARACTER = Fraction(1, 10_000)


UNIT = {"firmware": "register_slave", "modules": ["I2C-A", "GPIO"], "pins": {"LED": 12}}
TABLES = {"name": "watched", "duration": "1 s", "unit": {"dsp": UNIT}}
COMMON = {"wire": "LED", "tolerance": "20 us"}


def case(**watch: Any) -> Case:
    return Case.model_validate({**TABLES, "watch": {"led": {**COMMON, **watch}}})


def drawn(diagram: str, **watch: Any) -> Verdict:
    """The verdict about a wire that a party drives as in the diagram."""
    scene = Scene(case(**watch))
    wire = scene.wires["LED"].attach("party")
    wire.drive(int(diagram[0] == "~"))
    for number, (before, after) in enumerate(pairwise(diagram), 1):
        if before != after:
            tick = scene.start + scene.timebase.ticks(number * CHARACTER)
            scene.kernel.call_at(tick, lambda level=int(after == "~"): wire.drive(level))
    (verdict,) = scene.run(len(diagram) * CHARACTER).budgets
    return verdict


def summary(verdict: Verdict) -> tuple[str, float | None, str]:
    return verdict.verdict, verdict.worst, verdict.found


TOO_FEW = " of LED occurred, and a period needs two; let the run last longer"
STOPPED = "LED stopped: its last rise was at 0.000500 s"
EDGES = [["200 us", "rise"], ["510 us", "fall"], ["700 us", "rise"]]
# settings of the watcher; the diagram; verdict, worst deviation in us, explanation
DIAGRAMS: list[tuple[dict[str, Any], str, tuple[str, float | None, str]]] = [
    ({"edges": EDGES}, "__~~~__~~", ("pass", 10.0, "")),
    ({"edges": EDGES}, "__~~__~~~", ("fail", 110.0, "")),
    ({"edges": EDGES}, "_________", ("fail", None, "a rise of LED was expected at 0.000200 s, and did not come")),
    ({"edges": EDGES}, "__~~~____", ("fail", 10.0, "a rise of LED was expected at 0.000700 s, and did not come")),
    (
        {"edges": EDGES},
        "~~_~~__~~",
        ("fail", None, "a rise of LED was expected at 0.000200 s; a fall of LED came at 0.000200 s"),
    ),
    ({"edges": EDGES}, "__~~~__~_", ("fail", 10.0, "a fall of LED came at 0.000800 s, after the last expected one")),
    ({"edges": EDGES, "more": True}, "__~~~__~_", ("pass", 10.0, "")),
    ({"edges": EDGES}, "__~~~_", ("pass", 10.0, "")),  # the last one is not due yet
    ({"edges": EDGES}, "__~~~__", ("pass", 10.0, "")),  # the last one is due, but can still be up to 20 us late
    ({"edges": EDGES}, "_", ("not judged", None, "the run ended before the first edge was due; let it last longer")),
    ({"edges": EDGES, "after": "150 us"}, "~___~__~~", ("fail", 200.0, "")),
    ({"edges": [["0 us", "rise"], ["200 us", "fall"]], "since": "first edge"}, "____~~__", ("pass", 0.0, "")),
    ({"edges": [["0 us", "rise"], ["200 us", "fall"]], "since": "first edge"}, "____~~~_", ("fail", 100.0, "")),
    (
        {"edges": [["0 us", "rise"]], "since": "first edge"},
        "___",
        ("fail", None, "a rise of LED was expected from 0.000000 s on, and did not come"),
    ),
    ({"kind": "blink", "rate": "2.5 kHz"}, "_~~__~~__~~_", ("pass", 0.0, "")),
    ({"kind": "blink", "rate": "2.5 kHz"}, "_~___~~__~__", ("pass", 0.0, "")),  # the on-time is not judged
    ({"kind": "blink", "rate": "2.5 kHz", "duty": "50 %"}, "_~___~~__~_", ("fail", 100.0, "")),
    ({"kind": "blink", "rate": "2.5 kHz"}, "_~~__~~___~~", ("fail", 100.0, "")),
    ({"kind": "blink", "rate": "2.5 kHz"}, "_~~__~~______", ("fail", 0.0, STOPPED)),
    ({"kind": "blink", "rate": "2.5 kHz"}, "____________", ("fail", None, "LED did not rise by 0.000800 s")),
    ({"kind": "blink", "rate": "2.5 kHz"}, "_________~~__~~_", ("fail", 0.0, "LED did not rise by 0.000800 s")),
    ({"kind": "blink", "rate": "2.5 kHz"}, "________~~__~~__", ("pass", 0.0, "")),  # just in time
    ({"kind": "blink", "rate": "2.5 kHz", "first": "2 ms"}, "_________", ("not judged", None, f"no rise{TOO_FEW}")),
    ({"kind": "blink", "rate": "2.5 kHz"}, "_~~_", ("not judged", None, f"one rise{TOO_FEW}")),
    ({"kind": "blink", "rate": "2.5 kHz"}, "_~~__", ("not judged", None, f"one rise{TOO_FEW}")),  # one is due
    ({"kind": "blink", "rate": "2.5 kHz"}, "________", ("not judged", None, f"no rise{TOO_FEW}")),  # one is due
    ({"kind": "blink", "rate": "2.5 kHz", "after": "300 us"}, "~_~_~~__~~__", ("pass", 0.0, "")),
    (
        {"kind": "blink", "rate": "2.5 kHz", "after": "400 us"},  # the rise at this time is not judged
        "~_~_~~__~~__",
        ("not judged", None, f"one rise{TOO_FEW}"),
    ),
    (
        {"edges": [["700 us", "rise"]], "after": "200 us"},
        "__~~~~~~~~",
        ("fail", None, "a rise of LED was expected at 0.000700 s, and did not come"),
    ),
]


@pytest.mark.parametrize(("watch", "diagram", "expected"), DIAGRAMS)
def test_the_verdict_about_a_diagram(watch: dict[str, Any], diagram: str, expected: tuple[str, float | None, str]):
    verdict = drawn(diagram, **{"kind": "edges", **watch})
    assert summary(verdict) == expected
    assert (verdict.name, verdict.measure, verdict.limit) == ("led", "watch:led", 20.0)


@pytest.mark.parametrize(("level", "missing"), [(1, ""), (0, "")])
def test_edges_at_the_end_of_the_run_are_not_reported_as_missing(level: int, missing: str):
    """The only edge is the expected one, or one in the wrong direction."""
    refuted: list[str] = []
    place = WatchContext(
        "LED", lambda seconds: int(seconds * 10**6), 0, 5, lambda *_: None, lambda why, _: refuted.append(why)
    )
    settings = edges.Settings.model_validate({"edges": [["10 us", "rise"], ["50 us", "fall"]]})
    watcher = edges.build(settings, place)
    watcher.edge(10, level)
    watcher.finish(60)
    assert watcher.missing() == missing and len(refuted) == 1


@pytest.mark.parametrize(
    ("watch", "sentence"),
    [
        ({"kind": "edge", "edges": EDGES}, "watch.led.kind: there is no kind of watcher 'edge'; did you mean edges?"),
        ({"kind": "edges"}, "watch.led.edges: "),
        ({"kind": "edges", "edges": []}, "watch.led.edges: "),
        ({"kind": "edges", "edges": EDGES, "wire": "LAD"}, "watch.led.wire: there is no wire 'LAD'; did you mean LED"),
        ({"kind": "edges", "edges": EDGES, "rate": "1 Hz"}, "a watcher of kind 'edges' has no such key"),
        ({"kind": "edges", "edges": EDGES[::-1]}, "edges are not in order of time"),
        ({"kind": "edges", "edges": [["1 ms", "up"]]}, "watch.led.edges"),
        ({"kind": "edges", "edges": EDGES, "since": "first edge"}, "so the first time must be 0"),
        ({"kind": "edges", "edges": EDGES, "after": "1 ms"}, "the first edge is not later than 'after'"),
        ({"kind": "edges", "edges": EDGES, "tolerance": "0"}, "tolerance"),
        ({"kind": "blink", "rate": "0 Hz"}, "a frequency is above 0"),
        ({"kind": "blink"}, "watch.led.rate: "),
        ({"kind": "blink", "rate": "1 Hz", "after": "2 s", "first": "1 s"}, "'first' is before 'after'"),
        ({"edges": EDGES}, "kind"),
    ],
)
def test_invalid_settings_are_rejected_with_one_sentence(watch: dict[str, Any], sentence: str):
    with pytest.raises((BadCase, ValueError)) as error:
        Scene(case(**watch))
    assert sentence in str(error.value)


def test_a_mistake_is_reported_with_its_line(tmp_path: Path):
    text = """name = "watched"
duration = "1 ms"
[unit.dsp]
firmware = "register_slave"
modules = ["I2C-A", "GPIO"]
pins = { LED = 12 }
[watch.led]
kind = "blink"
wire = "LED"
tolerance = "1 us"
rat = "1 kHz"
rate = "1 kHz"
"""
    file = tmp_path / "w.toml"
    two = '[[budget]]\nname = "led"\nmeasure = "round"\nmax = "1 s"\n'
    for change, sentence in [
        ("", "line 11: watch.led.rat: a watcher of kind 'blink' has no such key; did you mean rate?"),
        (two, "line 7: watch.led: there are two budgets 'led'"),
        ('[[budget]]\nname = "x"\nmeasure = "watch:lad"\nmax = "1 s"\n', "there is no [watch.lad]; did you mean led?"),
    ]:
        file.write_text((text if not change else text.replace('rat = "1 kHz"\n', "")) + change)
        with pytest.raises(BadCase) as error:
            Scene(load(file))
        assert sentence in str(error.value), change


def test_a_budget_of_the_case_can_limit_percentiles():
    watch = {"kind": "blink", **COMMON, "rate": "1 Hz"}
    own = {"name": "most", "measure": "watch:led", "p50": "1 us"}
    more = Case.model_validate({**TABLES, "watch": {"led": watch}, "budget": [own]})
    assert [(budget.name, budget.measure) for budget in more.budget] == [("most", "watch:led"), ("led", "watch:led")]
