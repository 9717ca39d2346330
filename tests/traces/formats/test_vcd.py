"""Value change dumps as written by simulators and sigrok, and broken ones."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.traces.formats import BadCapture, Capture, Span, vcd
from tests.refusals import refusal
from tests.traces.formats.looks import edges, facts


def read(tmp_path: Path, text: str, rate: int | None = None) -> Capture:
    path = tmp_path / "x.vcd"
    path.write_text(text, encoding="utf-8")
    return vcd.read(path, None if rate is None else Fraction(rate))


SIGROK = """$date Sat Nov 21 2026 $end
$version libsigrok 0.5.2 $end
$comment
  Acquisition with 2/8 channels at 4 MHz, 25 °C
$end
$timescale 10 ns $end
$scope module libsigrok $end
$var wire 1 ! SCL $end
$var wire 1 " My SDA $end
$upscope $end
$enddefinitions $end
#0 1! 1"
#2500 0"
#2675 0!
#250000
"""


def test_a_file_of_sigrok_has_time_and_values_on_one_line(tmp_path: Path):
    capture = read(tmp_path, SIGROK)
    assert edges(capture) == {"libsigrok.SCL": [1, 2675], "libsigrok.My SDA": [1, 2500]}
    assert facts(capture) == (10**8, 250_000, False)


def test_with_a_given_rate_positions_are_samples(tmp_path: Path):
    capture = read(tmp_path, SIGROK, 4_000_000)
    assert edges(capture) == {"libsigrok.SCL": [1, 107], "libsigrok.My SDA": [1, 100]}
    assert facts(capture) == (4_000_000, 10_000, True)


def test_a_file_of_a_simulator_is_read(tmp_path: Path):
    text = """
        $timescale 1ps $end
        $scope module tb $end $scope module bus $end
        $var parameter 32 #p CLKHZ $end $var wire 1 aa scl $end $var tri 1 !1 sda[0] $end
        $upscope $end $upscope $end
        $comment levels follow $end
        $enddefinitions $end
        #0
        $dumpvars
        1aa
        z!1
        b1010 #p
        $end
        #645807000000
        0!1
        $comment in between $end
        #2000000000000
        """
    capture = read(tmp_path, text)
    assert edges(capture) == {"tb.bus.scl": [1], "tb.bus.sda[0]": [1, 645807000000]}
    assert facts(capture) == (10**12, 2 * 10**12, False)
    assert capture.channel("scl").name == "tb.bus.scl"


@pytest.mark.parametrize(
    ("timescale", "rate"),
    [("1 s", 1), ("10 ms", 100), ("100us", 10_000), ("1 ns", 10**9), ("100 ps", 10**10), ("1fs", 10**15)],
)
def test_every_timescale(tmp_path: Path, timescale: str, rate: int):
    text = f"$timescale {timescale} $end $var wire 1 ! a $end #0 0! #7 1! #9"
    capture = read(tmp_path, text)
    assert facts(capture) == (rate, 9, False) and edges(capture) == {"a": [0, 7]}


def test_a_file_without_a_timescale_has_no_rate(tmp_path: Path):
    text = "$var wire 1 ! a $end #0 0! #7 1! #9"
    assert read(tmp_path, text).rate is None
    stated = read(tmp_path, text, 4_000_000)
    assert stated.rate == 4_000_000 and edges(stated) == {"a": [0, 7]}


def test_a_change_at_the_last_time_is_at_the_last_position(tmp_path: Path):
    assert read(tmp_path, "$var wire 1 ! a $end #0 0! #7 1!").length == 8
    assert read(tmp_path, "$var wire 1 ! a $end #0 0! #7 1! #7").length == 8
    assert read(tmp_path, "$var wire 1 ! a $end #0 0! #7").length == 7


def test_unknown_levels_are_spans(tmp_path: Path):
    capture = read(tmp_path, "$var wire 1 ! a $end $var wire 1 & b $end #3 0! x& #5 x! #8 1& #9 U! #10 0! #12")
    a, b = capture.channels
    assert (a.initial, a.edges.tolist(), a.unknown) == (0, [], (Span(0, 3), Span(5, 10)))
    assert (b.initial, b.edges.tolist(), b.unknown) == (1, [], (Span(0, 8),))


AS_OTHER_TOOLS_WRITE_IT = """
    $timescale 1 ns $end
    $var string 0 s EE $end $var wire 0 w none $end $var wire 1 ! bit [3] $end $var integer 4 i count $end
    $enddefinitions $end
    #0
    1 !
    sABC s
    b0 w
    b0101 i
    #4
    0 !
    #9
    """


@pytest.mark.parametrize(
    ("text", "found"),
    [
        pytest.param(
            "$var wire 1 ! a $end $enddefinitions $end $dumpvars 1! $end #5 0! #9",
            {"a": [1, 5]},
            id="values before the first time hold from the start",
        ),
        pytest.param(
            "$var wire 1 ! a $end $var wire 1 ! b $end #0 0! #5 1! #9",
            {"a": [0, 5], "b": [0, 5]},
            id="two variables of one identifier are one line",
        ),
        pytest.param(
            "$var real 64 r volts $end $var string 1 s state $end $var wire 1 ! a $end #0 r1.5 r sIDLE s 0! #5 1! #9",
            {"a": [0, 5]},
            id="reals and strings are left out",
        ),
        pytest.param(
            AS_OTHER_TOOLS_WRITE_IT,
            {"bit[3]": [1, 4], "count[3]": [0], "count[2]": [1], "count[1]": [0], "count[0]": [1]},
            id="as other tools write it",
        ),
    ],
)
def test_edges_of_a_text(tmp_path: Path, text: str, found: dict[str, list[int]]):
    capture = read(tmp_path, text)
    assert edges(capture) == found and not any(channel.unknown for channel in capture.channels)


def test_a_vector_has_a_channel_per_bit_and_short_values_are_extended(tmp_path: Path):
    text = "$var wire 3 ! bus [5:3] $end $var reg 2 & r $end #0 b101 ! b0 & #4 b1 ! #6 bx1 ! #8 b10 & bz !"
    capture = read(tmp_path, text)
    assert edges(capture) == {
        "bus[5]": [1, 4, 8],  # unknown from 6 to 8, then high as z
        "bus[4]": [0, 8],
        "bus[3]": [1],
        "r[1]": [0, 8],
        "r[0]": [0],
    }
    assert capture.channel("bus[5]").unknown == (Span(6, 8),)


def test_rounded_times_are_moved_to_the_grid_of_the_rate(tmp_path: Path):
    ticks = [round(n * 1000 / 24) for n in range(0, 2400, 7)]
    changes = " ".join(f"#{tick} {n & 1}!" for n, tick in enumerate(ticks))
    capture = read(tmp_path, f"$timescale 1 ns $end $var wire 1 ! a $end {changes}", 24_000_000)
    assert capture.channels[0].edges.tolist() == list(range(7, 2400, 7))


@given(st.lists(st.tuples(st.integers(1, 10**6), st.sampled_from("01")), min_size=1, max_size=30))
@settings(deadline=None)
def test_any_changes_are_read(tmp_path_factory: pytest.TempPathFactory, steps: list[tuple[int, str]]):
    now, text, expected, level = 0, ["$timescale 1 ns $end $var wire 1 ! a $end #0 1!"], [1], "1"
    for wait, value in steps:
        now += wait
        text.append(f"#{now} {value}!")
        if value != level:
            expected.append(now)
            level = value
    assert edges(read(tmp_path_factory.mktemp("vcd"), "\n".join(text))) == {"a": expected}


DECLARED = "$timescale 1 ns $end\n$var wire 1 ! a $end\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("quack", "line 1: found 'quack', expected a time, a change or a $ command; write the dump again"),
        (DECLARED, "the file: found no time, expected changes after a #; dump a run"),
        (
            "$timescale 1 ns $end #0",
            "the file: found no one-bit variable, expected at least one; dump the lines of the bus",
        ),
        (
            "$timescale 3 ns $end",
            "line 1: found timescale '3ns', expected 1, 10 or 100 of s, ms, us, ns, ps or fs; mend it",
        ),
        (
            "$var wire 1 !",
            "line 1: found the end of the file after '$var', expected the rest of it; copy the file again",
        ),
        (
            "$var wire x ! a $end",
            "line 1: found $var wire x ! a, expected type, width (to 1024), identifier and name; mend it",
        ),
        (
            DECLARED + "$var wire 2 ! b $end",
            "line 3: found 2 bits for identifier '!', expected 1 as before; mend it",
        ),
        (DECLARED + "#5 1!\n#4 0!", "line 4: found time 4 after 5, expected times that rise; write the dump again"),
        (
            DECLARED + "#x",
            "line 3: found '#x', expected # and a number of ticks to 4611686018427387904; write the dump again",
        ),
        (
            DECLARED + "#99999999999999999999",
            "line 3: found '#99999999999999999999', expected # and a number of ticks to 4611686018427387904; "
            "write the dump again",
        ),
        (
            DECLARED + "#0 1?",
            "line 3: found a change of '?', expected an identifier that a $var declares; write the dump again",
        ),
        (
            DECLARED + "#0 b101 !",
            "line 3: found value '101', expected 1 of the states 0, 1, x and z; write the dump again",
        ),
    ],
)
def test_an_error_is_reported_with_its_line(tmp_path: Path, text: str, message: str):
    assert refusal(BadCapture, read, tmp_path, text) == f"{tmp_path}/x.vcd, {message}"


def test_a_wrong_rate_is_rejected(tmp_path: Path):
    assert refusal(BadCapture, read, tmp_path, SIGROK.replace("#2675", "#2680"), 4_000_000) == (
        f"{tmp_path}/x.vcd, its times: found a change at #2680, expected times on the grid of 4000000 Hz; "
        "state the right rate or none"
    )


def test_a_time_beyond_64_bits_at_the_rate_is_rejected(tmp_path: Path):
    text = "$timescale 100 s $end\n$var wire 1 ! a $end\n#0\n0!\n#4000000000000000000\n1!\n"
    assert edges(read(tmp_path, text)) == {"a": [0, 4 * 10**18]}
    assert refusal(BadCapture, read, tmp_path, text, 10**9) == (
        f"{tmp_path}/x.vcd, its times: found sample 4{'0' * 29} of 1 GHz, expected at most {1 << 62}; "
        "state the right rate or none"
    )


CUT = SIGROK.replace("#250000", "#2")


def test_with_salvage_a_file_is_read_up_to_the_error(tmp_path: Path):
    (tmp_path / "x.vcd").write_text(CUT, encoding="utf-8")
    with pytest.raises(BadCapture):
        vcd.read(tmp_path / "x.vcd")
    capture = vcd.read(tmp_path / "x.vcd", salvage=True)
    assert edges(capture) == {"libsigrok.SCL": [1, 2675], "libsigrok.My SDA": [1, 2500]}
    assert (capture.length, capture.notes) == (
        2676,
        ("read up to tick 2675: line 15: found time 2 after 2675, expected times that rise; write the dump again",),
    )


@pytest.mark.parametrize("text", ["quack", "$timescale 1 ns $end $var wire 1 ! a $end 1! quack"])
def test_a_file_without_a_time_cannot_be_salvaged(tmp_path: Path, text: str):
    (tmp_path / "x.vcd").write_text(text)
    with pytest.raises(BadCapture, match="line 1: found 'quack'"):
        vcd.read(tmp_path / "x.vcd", salvage=True)


def test_a_line_without_an_end_and_too_many_changes_are_rejected(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    with pytest.raises(BadCapture, match=r"line 3: found a line of more than 1048576 bytes, expected shorter ones"):
        read(tmp_path, DECLARED + "#0 1! " * 200_000)
    monkeypatch.setattr(vcd, "MOST_LINES", 4096)
    with pytest.raises(BadCapture, match=r"line 6: found more than 4096 bits, expected fewer lines"):
        read(tmp_path, "$timescale 1 ns $end\n" + "".join(f"$var wire 1024 a{n} a $end\n" for n in range(6)))
    monkeypatch.setattr(vcd, "MOST_EDGES", 20)
    with pytest.raises(BadCapture, match=r"line \d\d: found more than 20 changes, expected a shorter run"):
        read(tmp_path, DECLARED + "\n".join(f"#{n}\n{n & 1}!" for n in range(20)))
