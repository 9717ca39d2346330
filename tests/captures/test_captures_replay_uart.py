"""The real UART captures are replayed to the SCI: it receives the words of the oracle, with their error bits.

Where the oracle is wrong, the sent byte is known, and the SCI receives that byte.
"""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from functools import cache
from pathlib import Path

import pytest

from periph_sim.replay.report import Report
from periph_sim.replay.uart import LEAD, UartReplay, line_format
from periph_sim.scene.case.load import load as load_case
from tests.captures.test_captures_decode import channel, load, options
from tests.captures.where import decoded, needs_captures, oracle

CASE = Path(__file__).resolve().parents[2] / "timing" / "uart_logger.toml"

# One-sample glitches of 500 ns at the sampling instant, with the value that a receiver reads which samples once: two in
# the middle of a data bit (4F was sent, as the names of the captures say), one in the start bit.
AMBIGUOUS = {"uart_glitch_0x4f_2": "5F", "uart_glitch_0x45": "45", "uart_glitch_4f": "5F"}

# The captures with errors, and the flags of the SCI. A LIN break of 13 or 14 bits is a byte 00 with FE without BRKDT,
# which needs ten bits after the missing stop bit. Both lines of uart_mdfu_client_info are low at the end.
FLAGGED = {
    ("uart_7e1_break", "rx"): {"FE": 2},
    ("uart_lin_burst", "rx"): {"FE": 10},
    ("uart_lin_single", "rx"): {"FE": 1},
    ("uart_mdfu_client_info", "rx"): {"FE": 1, "BRKDT": 1},
    ("uart_mdfu_client_info", "tx"): {"FE": 1, "BRKDT": 1},
}

# Lines that are low at the first sample: the part before is unknown, and is not replayed.
BEGINS_LOW = {
    ("uart_gps_9600", "tx"),
    ("uart_mdfu_client_info", "tx"),
    ("uart_pan1321_115200_undersampled", "rx"),
    ("uart_pan1321_115200_undersampled", "tx"),
}

LINES = [(name, side) for name in decoded("uart") for side in ("rx", "tx") if side in options(name, "uart")]


@cache
def replayed(name: str, side: str) -> Report:
    given = options(name, "uart")
    frame = f"{given.get('data_bits', '8')}{given.get('parity', 'none')[0]}1"
    line = line_format(int(given["baudrate"]), frame)
    return UartReplay(load_case(CASE), load(name), channel(name, given[side]), line).run()


@pytest.mark.parametrize(("name", "side"), LINES)
def test_the_sci_receives_what_was_sent(name: str, side: str):
    report = replayed(name, side)
    if name in AMBIGUOUS:
        assert report.verdict == "ambiguous" and report.divergences == []
        assert (report.events, report.agreed, report.ambiguous, report.bytes) == (1, 0, 1, 1)
        (note,) = [note for note in report.notes if "glitch" in note]
        assert f"{AMBIGUOUS[name]} where each bit is sampled once" in note
        return
    assert report.first_divergence is None and report.verdict == "pass"
    assert report.bytes == report.events == report.agreed > 0
    assert {flag: count for flag, count in report.errors.items() if count} == FLAGGED.get((name, side), {})
    assert any("begins with the line low" in note for note in report.notes) == ((name, side) in BEGINS_LOW)


@pytest.mark.parametrize("name", decoded("uart"))
def test_no_byte_of_the_oracle_is_missing(name: str):
    """Every start bit in the oracle's file is a word that the SCI received."""
    sides = [side for side in ("rx", "tx") if side in options(name, "uart")]
    counts = Counter(said.text for said in oracle(name, "uart"))
    reports = [replayed(name, side) for side in sides]
    assert sum(report.bytes for report in reports) == counts["Start bit"]
    assert sum(report.errors["FE"] for report in reports) == counts["Frame error"]
    assert sum(report.errors["PE"] for report in reports) == counts["Parity error"] == 0


@needs_captures
@pytest.mark.parametrize(
    ("name", "sent", "right"),
    [("uart_glitch_0x20", "20", 40), ("uart_glitch_0x4f_2", "4F", 40), ("uart_glitch_0x45", "45", 22)],
)
def test_a_glitch_is_outvoted_in_each_phase_of_the_sampling_clock(name: str, sent: str, right: int):
    """Forty phases of SCICLK are tried (41 LSPCLK at BRR = 40).

    uart_glitch_0x45 has a glitch in its start bit, which needs four consecutive low samples: there the phase decides.
    """
    case, capture = load_case(CASE), load(name)
    channel_of = options(name, "uart")["rx"]
    step = Fraction(41, 37_500_000) / 40
    found = []
    for phase in range(40):
        replay = UartReplay(case, capture, channel_of, line_format(115_200), lead=LEAD + phase * step)
        replay.run()
        found.append([word.happened.words for word in replay.received()])
    assert found.count([sent]) == right


@needs_captures
def test_odd_parity_read_as_even_is_an_error_in_every_word_and_not_judged():
    """The multimeter sends 7o1; its documentation says 7e1."""
    report = UartReplay(load_case(CASE), load("uart_es51978_2400_7o1"), "RX", line_format(2400, "7e1")).run()
    assert report.first_divergence is None and report.errors["PE"] == report.bytes == 66
    assert report.verdict == "not judged" and "fit 2400 baud, 7o1" in report.unjudged
