"""A report of bounds whole: as lines and as JSON, from terms given by hand; each sum is that of its terms."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from msgspec import structs

from periph_sim.core.text_table import paragraph
from periph_sim.core.time import Timebase
from periph_sim.explain.bound.compare_with_run import BoundWithRun, Report
from periph_sim.explain.bound.limits import LimitCheck
from periph_sim.explain.bound.service_routine import NONE, ServiceRoutines
from periph_sim.explain.bound.terms import Bound, Term
from periph_sim.explain.bound.text_report import MEASURED, as_json, text

CYCLE = 20  # ticks
US = 150 * CYCLE
CODE, POLL = Term("code", 100 * CYCLE, "its code"), Term("poll pass", 50 * CYCLE, "unit.dsp.poll_pass")
ENTRY = Term("interrupt entry", 17 * CYCLE, "int_latency 17")
RESPONSE = Bound("response", "response", (CODE, POLL))
HELD = Bound("stretch", "stretch", (Term("reaction", 30 * CYCLE, "response"), Term("bit", -CYCLE // 2, "rate")))
FLOORED = structs.replace(HELD, floor=Term("none is shorter", US, "the bus"))
LEAST = Bound("margin", "I2CDXR margin", (Term("nine bits", 9 * US, "rate"), CODE.taken_off()), least=True)
COUNTED = Bound("FIFO", "SCI FIFO high-water", (Term("words", 12, "the frame"),), counted=True)
OPEN = Bound("age", "age", (Term("model", 3 * US, "measured", "'if x' decides what runs"),))
REPORT = Report(
    "made",
    0.1,
    Timebase(150_000_000),
    Fraction(CYCLE),
    ServiceRoutines((ENTRY,), 1, 1, 0, 0),
    (
        Bound("first request", "", (Term("first request", US, "controller.first"), POLL.taken_off())),
        Bound("second request", "", (Term("first request", US, "controller.first"), POLL.taken_off())),
        Bound("SDIR", "", (Term("clock", 60, "rate"),)),
    ),
    8,
    (
        BoundWithRun(RESPONSE, 100 * CYCLE, 7),
        BoundWithRun(FLOORED, 0, 2),
        BoundWithRun(LEAST, 9 * US, 3),
        BoundWithRun(COUNTED, 6, 1),
        BoundWithRun(OPEN, 4 * US, 5),
    ),
    (),
    (
        LimitCheck("reaction", "response", "max", US, RESPONSE),
        LimitCheck("margin", "I2CDXR margin", "min", 9 * US, LEAST),
        LimitCheck("words", "SCI FIFO high-water", "p99_9", 12, COUNTED),
        LimitCheck("wrong", "wrong bytes", "max", 0, None, "bytes are data"),
        LimitCheck("other", "wrong bytes", "max", 0, None, "bytes are data"),
        LimitCheck("other", "wrong bytes", "min", 0, None, "bytes are data"),
        LimitCheck("old", "age", "max", US, None, "no closed form is known"),
    ),
)

LINES = f"""\
made: margin may break its limit, by 0.667 us; 0.1 s simulated to compare
assumes rates as received, no frame left out, no other interrupt, no dependence on data

 measure    calculated      seen  ratio  values
 ──────────────────────────────────────────────
 response  <= 1.000 us  0.667 us  1.500       7
 stretch   <= 1.000 us  0.000 us      -       2
 margin    >= 8.333 us  9.000 us  1.080       3
 FIFO            <= 12         6  2.000       1
 age              none  4.000 us      -       5

 budget           limit  calculated      spare
 ────────────────────────────────────────────────────────
 reaction  max 1.000 us    1.000 us   0.000 us  holds
 margin    min 9.000 us    8.333 us  -0.667 us  may break
 words         p99.9 12          12          0  holds
  not calculated: wrong, other (bytes are data)
  not calculated: old (no closed form is known)

response: at most 1.000 us
        100 cycles       0.667 us  code  [its code]
         50 cycles       0.333 us  poll pass  [unit.dsp.poll_pass]

stretch: at most 1.000 us
        150 cycles       1.000 us  none is shorter  [the bus]
  or, if that is more, the sum of 0.197 us
         30 cycles       0.200 us  reaction  [response]
       -0.5 cycles      -0.003 us  bit  [rate]

margin: at least 8.333 us
       1350 cycles       9.000 us  nine bits  [rate]
       -100 cycles      -0.667 us  code  [its code]
  SCL is free with 7 cycles more before each write; from 8 on it may be held

FIFO: at most 12
         12  words  [the frame]

age: not calculated; what was measured adds up to 3.000 us
        450 cycles       3.000 us  model  [measured]
            not calculated, since 'if x' decides what runs

time left before the deadlines that the calculation needs:

first request, second request: 0.667 us
        150 cycles       1.000 us  first request  [controller.first]
        -50 cycles      -0.333 us  poll pass  [unit.dsp.poll_pass]

SDIR: 0.020 us
          3 cycles       0.020 us  clock  [rate]

one interrupt: 0.113 us
         17 cycles       0.113 us  interrupt entry  [int_latency 17]

{chr(10).join(paragraph(MEASURED))}"""


def test_a_report_as_lines():
    assert [line.rstrip() for line in text(REPORT).splitlines()] == LINES.splitlines()


def test_what_there_is_none_of_is_left_out():
    bare = replace(REPORT, handlers=NONE, deadlines=(), beside=(), limits=())
    assert text(bare).splitlines() == [
        "made: no budget limits what is calculated; 0.1 s simulated to compare",
        "assumes rates as received, no frame left out, no other interrupt, no dependence on data",
        *("", "time left before the deadlines that the calculation needs:", "", *paragraph(MEASURED)),
    ]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"limits": REPORT.limits[:1]}, "calculated values are within their limits"),
        ({"limits": REPORT.limits[3:]}, "no budget limits what is calculated"),
        ({"limits": (LimitCheck("it", "response", "max", US - 60, RESPONSE),)}, "it may break its limit, by 0.020 us"),
        (
            {"limits": (LimitCheck("it", "response", "max", -899_999 * US, RESPONSE),)},
            "it may break its limit, by 900.000 ms",
        ),
        (
            {"beside": (BoundWithRun(RESPONSE, US + 1, 1), BoundWithRun(LEAST, 1, 1)), "limits": ()},
            "response and margin seen beyond the calculated value",
        ),
        (
            {"beside": (BoundWithRun(RESPONSE, None, 0), BoundWithRun(LEAST, None, 0)), "limits": ()},
            "of response and margin nothing was seen, so nothing is compared",
        ),
        ({"hung": ("dsp waits for ever",)}, "margin may break its limit, by 0.667 us; dsp waits for ever"),
        (
            {
                "limits": (
                    LimitCheck("old", "age", "max", US, None, "a wait may time out", unproven=True),
                    LimitCheck("old", "age", "p50", US, None, "a wait may time out", unproven=True),
                    LimitCheck("slow", "age", "max", US, None, "'if x' decides what runs", unproven=True),
                )
            },
            "old, slow not calculated: a wait may time out; 'if x' decides what runs",
        ),
        (
            {"deadlines": (Bound("SDIR", "", (Term("late", -60, ""),)), Bound("XRDY", "", (Term("late", -3000, ""),)))},
            "nothing calculated: SDIR up to 0.020 us too soon; XRDY up to 1.000 us too soon",
        ),
    ],
)
def test_the_first_line_says_what_is_wrong(changes: dict[str, object], said: str):
    told = text(replace(REPORT, **changes)).splitlines()[0]  # type: ignore[arg-type]
    end = "" if said.startswith("nothing calculated") else "; 0.1 s simulated to compare"
    assert told == f"made: {said}{end}"


def limits_of(*limits: LimitCheck) -> list[str]:
    """The lines about these limits."""
    return text(replace(REPORT, beside=(), limits=limits)).split("\n\n")[1].splitlines()


def test_limits_have_a_head_where_one_of_them_is_bounded():
    assert [line.split()[0] for line in limits_of(REPORT.limits[0])] == ["budget", "─" * 51, "reaction"]
    assert limits_of(REPORT.limits[3]) == ["  not calculated: wrong (bytes are data)"]


def test_a_reason_is_wrapped_at_80_characters():
    reason = "x" * 54
    fits, wrapped = (limits_of(LimitCheck(name, "age", "max", 0, None, reason)) for name in ("b" * 5, "b" * 6))
    assert fits == [f"  not calculated: bbbbb ({reason})"] and len(fits[0]) == 80
    assert wrapped == ["  not calculated: bbbbbb", f"    ({reason})"]


def test_a_margin_that_is_used_up_says_so():
    lines = text(replace(REPORT, held_from=0)).splitlines()
    assert "  SCL may be held for it already" in lines and not any("cycles more" in line for line in lines)


def test_a_report_as_json():
    told = as_json(REPORT)
    bounds, limits, deadlines = told["calculated"], told["limits"], told["deadlines"]
    assert isinstance(bounds, list) and isinstance(limits, list) and isinstance(deadlines, list)
    assert bounds[0] == {
        "measure": "response",
        "from_below": False,
        "reason": "",
        "calculated": {"us": 1.0, "cycles": 150.0},
        "seen": {"us": 2 / 3, "cycles": 100.0},
        "ratio": 1.5,
        "values": 7,
        "holds": True,
        "floor": [],
        "terms": [
            {"what": "code", "us": 2 / 3, "cycles": 100.0, "source": "its code", "reason": ""},
            {"what": "poll pass", "us": 1 / 3, "cycles": 50.0, "source": "unit.dsp.poll_pass", "reason": ""},
        ],
    }
    assert bounds[1]["floor"] == [
        {"what": "none is shorter", "us": 1.0, "cycles": 150.0, "source": "the bus", "reason": ""}
    ]
    assert (bounds[1]["ratio"], bounds[2]["from_below"]) == (None, True)
    words = bounds[3]
    assert (words["calculated"], words["seen"], words["terms"][0]["count"]) == ({"count": 12}, {"count": 6}, 12)
    assert bounds[4]["reason"] == bounds[4]["terms"][0]["reason"] == "'if x' decides what runs"
    assert limits[1] == {
        "budget": "margin",
        "measure": "I2CDXR margin",
        "key": "min",
        "calculated": True,
        "spare": {"us": -2 / 3, "cycles": -100.0},
        "reason": "",
    }
    assert (limits[2]["spare"], limits[3]["spare"]) == ({"count": 0}, None)
    assert (limits[3]["calculated"], limits[3]["reason"]) == (False, "bytes are data")
    assert (deadlines[2]["what"], deadlines[2]["spare"]) == ("SDIR", {"us": 0.02, "cycles": 3.0})
    assert [term["what"] for term in deadlines[0]["terms"]] == ["first request", "poll pass"]
    whole = {key: value for key, value in told.items() if not isinstance(value, list)}
    assert whole == {"case": "made", "simulated_s": 0.1, "holds": True, "passed": False, "held_from_cycles": 8}
    assert told["assumes"] == ["rates as received", "no frame left out", "no other interrupt", "no dependence on data"]
    assert (told["hung"], told["interrupt"]) == ([], [bounds_term(ENTRY)])
    unseen = as_json(replace(REPORT, beside=(BoundWithRun(RESPONSE, None, 0),), hung=("dsp waits",)))
    assert isinstance(unseen["calculated"], list) and unseen["hung"] == ["dsp waits"]
    assert unseen["calculated"][0]["seen"] is None


def bounds_term(term: Term) -> dict[str, object]:
    """A term that is a time, as JSON."""
    cycles = term.ticks / CYCLE
    return {"what": term.what, "us": cycles / 150, "cycles": cycles, "source": term.source, "reason": term.unproven}
