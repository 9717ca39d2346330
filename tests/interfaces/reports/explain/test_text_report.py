"""A chain whole: as lines, where each column is as wide as it has to be, and as JSON."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from periph_sim.interfaces.reports.explain.chain import Chain, FirmwarePlace, Part, Step, as_json, relative, text
from periph_sim.timing.verdict import Verdict
from tests.interfaces.reports.explain.made import TIMEBASE

US = TIMEBASE.per_second // 1_000_000
LOOP = FirmwarePlace("batch_read", 106, Path.cwd() / "firmware" / "imu_hil.py")
RECORDED = FirmwarePlace("sci_received", 60, None)
VERDICT = Verdict("stretch", "stretch", "us", 97.953, 50, -47.953, 9, "fail", 0.105195)
CHAIN = Chain(
    VERDICT,
    TIMEBASE,
    100 * US,
    steps=(
        Step(-190 * US, "repeated START"),
        Step(-2 * US, "SCIRXINTA entered", 12_345 * US, LOOP),
        Step(100 * US, "SCL rises", place=RECORDED),
    ),
    parts=(Part("code", "", 60 * US, 2, LOOP), Part("span", "frame", 40 * US, place=RECORDED)),
    typical=75 * US,
    more=(Part("span", "frame", 40 * US, place=RECORDED), Part("code", "", -15 * US, 2)),
)
HEAD = "stretch 97.953 us, at most 50.000 us allowed, at 0.105195 s"


def test_a_chain_as_lines():
    assert text(CHAIN) == [
        HEAD,
        "    -190.000 us             repeated START",
        "      -2.000 us  12.345 ms  SCIRXINTA entered [imu_hil.py:106 (batch_read)]",
        "     100.000 us             SCL rises [sci_received:60]",
        "  made up of",
        "    60.000 us  60.0 %  other code, 2 times [imu_hil.py:106 (batch_read)]",
        "    40.000 us  40.0 %  span frame [sci_received:60]",
        "  +25.000 us against 75.000 us, its least critical occurrence",
        "    +40.000 us  span frame",
        "    -15.000 us  other code",
    ]


@pytest.mark.parametrize(
    ("ticks", "typical", "said"),
    [(15 * US, 15 * US, "0.000 us"), (2, 1, "+0.000 us"), (1, 2, "-0.000 us"), (15 * US, None, "+15.000 us")],
)
def test_only_what_is_longer_has_a_plus(ticks: int, typical: int | None, said: str):
    told = text(replace(CHAIN, length=ticks, typical=typical, steps=(), parts=()))[1]
    usual = f"{float(CHAIN.us(typical or 0)):.3f} us"
    assert told == f"  {said} against {usual}, its least critical occurrence"


@pytest.mark.parametrize(("us", "said"), [(9999, "9999.000 us"), (10_000, "10.000 ms"), (-10_000, "-10.000 ms")])
def test_from_ten_milliseconds_on_a_length_is_told_in_them(us: int, said: str):
    assert text(replace(CHAIN, steps=(Step(us * US, "SCL rises"),)))[1] == f"    {said}  SCL rises"


def test_of_many_parts_the_six_largest_are_told():
    lengths = (1, 7, 3, -6, 5, 2, 4)
    told = text(replace(CHAIN, steps=(), parts=(), more=tuple(Part("span", f"s{n}", n * US) for n in lengths)))
    assert [line.rpartition(" ")[2] for line in told[2:]] == ["s7", "s-6", "s5", "s4", "s3", "s2"]
    assert told[2:4] == ["    +7.000 us  span s7", "    -6.000 us  span s-6"]


@pytest.mark.parametrize(
    ("changes", "head"),
    [
        ({"which": "min"}, HEAD.replace("most", "least")),
        ({"which": "exactly"}, HEAD.replace("at most", "exactly")),
        ({"which": "p99_9"}, HEAD.replace("at most", "p99.9 at most")),
        ({"unit": "count", "worst": 3, "limit": 2, "at_s": None}, "stretch 3, at most 2 allowed, at -"),
        ({"worst": None}, "stretch: nothing was measured"),
    ],
)
def test_the_head_tells_the_limit_by_its_key(changes: dict[str, object], head: str):
    bare = Chain(replace(VERDICT, **changes), TIMEBASE, 0, ())  # type: ignore[arg-type]
    assert text(bare) == [head]


def test_a_chain_as_json():
    file = {"file": "firmware/imu_hil.py"}
    assert as_json(CHAIN) == {
        "steps": [
            {"at_us": -190.0, "what": "repeated START"},
            {"at_us": -2.0, "what": "SCIRXINTA entered", "length_us": 12345.0, "function": "batch_read", "line": 106}
            | file,
            {"at_us": 100.0, "what": "SCL rises", "function": "sci_received", "line": 60},
        ],
        "parts": [
            {"what": "other code", "length_us": 60.0, "count": 2, "function": "batch_read", "line": 106} | file,
            {"what": "span frame", "length_us": 40.0, "count": 1, "function": "sci_received", "line": 60},
        ],
        "length_us": 100.0,
        "typical_us": 75.0,
        "more": [
            {"what": "span frame", "length_us": 40.0, "count": 1, "function": "sci_received", "line": 60},
            {"what": "other code", "length_us": -15.0, "count": 2},
        ],
    }
    bare = as_json(Chain(VERDICT, TIMEBASE, 1, (Step(0, "SCL rises", 0),)))  # 0.333 ns
    assert (bare["length_us"], bare["typical_us"]) == (0.0003, None)
    assert bare["steps"] == [{"at_us": 0.0, "what": "SCL rises", "length_us": 0.0}]


def test_a_file_elsewhere_keeps_its_whole_path():
    assert relative(Path("/elsewhere/imu_hil.py")) == Path("/elsewhere/imu_hil.py")
