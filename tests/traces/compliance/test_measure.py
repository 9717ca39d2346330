"""Measured times of small drawn buses, and of random lines compared with a simple loop over the samples."""

from __future__ import annotations

from collections import defaultdict
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces import formats
from periph_sim.traces.capture.capture import Capture
from periph_sim.traces.compliance import Mode, Verdict, check
from periph_sim.traces.compliance.limits import Resolution
from periph_sim.traces.compliance.measure import CONTROLLER, PARTY, TARGET, Measures, measure
from periph_sim.traces.decode import i2c
from tests.traces.compliance.bus import EASY, Odd, Spike, sampled
from tests.traces.compliance.bus import drawn as bus_drawn
from tests.traces.decode.drawing import drawn, of_bytes

TRACES = Path(__file__).parents[3] / "traces"


def measured(capture: Capture, mode: Mode = Mode.STANDARD) -> Measures:
    return measure(capture, "SCL", "SDA", mode, Resolution(Fraction(10**6), 1))


def times(found: Measures, *symbols: str) -> dict[str, list[tuple[int, int]]]:
    """Map symbol to the (begin, length) of each measured time, without symbols that have none."""
    return {
        symbol: list(zip(of.begins.tolist(), of.lengths.tolist(), strict=True))
        for symbol, of in found.times.items()
        if len(of.begins) and (not symbols or symbol in symbols)
    }


def test_start_one_bit_and_stop():
    """The pulse that contains the STOP is not a bit, so it has no tVD."""
    found = times(
        measured(
            drawn("""
        SCL ---- ----____ __--- ______ ----------
        SDA ---- _______- ----- --____ ___-------
        """)
        )
    )
    assert found == {
        "tHD;STA": [(4, 4)],
        "tLOW": [(8, 6), (17, 6)],
        "tHIGH": [(14, 3)],
        "fSCL": [(8, 9)],
        "tHD;DAT": [(8, 3), (17, 2)],
        "tSU;DAT": [(11, 3), (19, 4)],
        "tVD;DAT": [(8, 3)],
        "tSU;STO": [(23, 3)],
    }


def test_a_repeated_start_and_the_free_bus():
    found = times(
        measured(
            drawn("""
        SCL --- ---___--------____------------____
        SDA --- _____-----_________----____-______
        """)
        ),
        "tSU;STA",
        "tHD;STA",
        "tSU;STO",
        "tBUF",
    )
    assert found == {
        "tHD;STA": [(3, 3), (13, 4), (31, 2)],
        "tSU;STA": [(9, 4)],
        "tSU;STO": [(21, 1)],
        "tBUF": [(22, 4), (30, 1)],
    }


def test_data_that_change_more_than_once_in_a_low_phase():
    """The first change ends the hold, the last one begins the set-up and makes the data valid."""
    found = times(
        measured(
            drawn("""
        SCL --- ---__________---____
        SDA --- _____-_-_--------___
        """)
        ),
        "tHD;DAT",
        "tSU;DAT",
        "tVD;DAT",
    )
    assert found["tHD;DAT"][0] == (6, 2) and found["tVD;DAT"] == [(6, 6)] and found["tSU;DAT"] == [(12, 4)]


def test_simultaneous_changes_of_both_lines_are_counted_and_make_no_condition():
    found = measured(
        drawn("""
    SCL --- ---____---_____---
    SDA --- ______-----____---
    """)
    )
    assert found.starts == 1 and found.shared.tolist() == [18]
    assert times(found)["tSU;DAT"] == [(9, 1), (18, 0)]
    found = measured(
        drawn("""
    SCL --- ---____---_____---
    SDA --- ___-------_____-_-
    """)
    )
    assert found.shared.tolist() == [6, 13, 18]
    assert times(found)["tHD;DAT"] == [(6, 0), (13, 0)]


def test_no_time_is_measured_across_an_unknown_span():
    whole = """
    SCL --- ---____----____----
    SDA --- __________________-
    """
    holed = """
    SCL --- ---__?_----____----
    SDA --- __________________-
    """
    assert times(measured(drawn(whole)), "tLOW", "fSCL") == {"fSCL": [(6, 8)], "tLOW": [(6, 4), (14, 4)]}
    assert times(measured(drawn(holed)), "tLOW", "fSCL") == {"tLOW": [(14, 4)]}


def test_tvd_ack_is_measured_at_the_ninth_bit():
    """SDA changes before three of the four ninth bits of each transfer: from 1 to ACK twice, from 0 to NACK once."""
    found = measured(bus_drawn(EASY[Mode.STANDARD]))
    assert len(found.times["tVD;ACK"].begins) == 2 * 3 and found.starts == 2 * 2


@pytest.mark.parametrize(
    ("bit", "party"),
    [
        ((0, 0), CONTROLLER),  # a 1 after START: it releases SDA
        ((1, 1), CONTROLLER),  # a 0 of written data
        ((1, 8), TARGET),  # the ACK of written data
        ((1, 0), TARGET),  # a 1 after the ACK of the address: the target releases SDA
        ((2, 8), TARGET),  # ACK of the read address
        ((3, 1), TARGET),  # a 1 of read data: it releases SDA
        ((3, 8), TARGET),  # NACK after a 0: the target releases SDA
    ],
)
def test_the_party_that_changed_sda(bit, party):
    late = EASY[Mode.STANDARD].but(odd={bit: Odd(data=(2_222,))})
    found = measured(bus_drawn(late)).times["tSU;DAT"]
    assert found.party[found.lengths == late.low - 2_222].tolist() == [party]


def test_the_fall_of_sda_before_a_stop_is_by_the_controller_even_after_read_data():
    found = measured(bus_drawn(EASY[Mode.STANDARD])).times
    setup = found["tSU;DAT"]
    ahead = np.isin(setup.begins + setup.lengths, found["tSU;STO"].begins)
    assert setup.party[ahead].tolist() == [CONTROLLER] * 2


def test_parties_agree_with_the_decoder():
    """SDA falls by the driver of the bit, and rises by the driver of the bit before, which releases it."""
    capture = formats.read(TRACES / "imu_round.sr")
    found = measured(capture).times["tSU;DAT"]
    who = dict(zip(found.begins.tolist(), found.party.tolist(), strict=True))
    level = capture.channel("SDA")
    seen = set()
    for transfer in i2c.transfers(capture):
        for phase in transfer.phases:
            before = i2c.Party.CONTROLLER
            for bit in (bit for byte in phase.bytes for bit in byte.bits):
                if bit.sda is not None and bit.sda in who:
                    falling = not level.levels[level.edges.searchsorted(bit.sda)]
                    expected = bit.driver if falling else before
                    assert PARTY[who[bit.sda]] is expected
                    seen.add((falling, expected))
                before = bit.driver
    assert len(seen) == 4, "both parties pull and release SDA"


def test_a_bus_with_reads_has_times_of_both_parties():
    found = measured(bus_drawn(EASY[Mode.FAST])).times["tVD;DAT"]
    assert {CONTROLLER, TARGET} == set(found.party.tolist())


# Random lines, compared with a loop over the samples.

SAMPLES = st.lists(st.tuples(st.integers(0, 3), st.integers(1, 4)), min_size=1, max_size=60).map(
    lambda runs: bytes(level for level, count in runs for _ in range(count))
)


def walked(samples: bytes) -> dict[str, list[tuple[int, int]]]:
    """The same times, computed by a simple loop. Bit 0 of a sample is SCL, bit 1 SDA."""
    found = defaultdict(list)
    fall = rise = first = last = hold = held_bit = None
    condition, condition_at, in_high = None, None, False  # the last condition; True if it is in this high phase
    number = 0  # rises of SCL since the condition

    def low_is_before_a_bit(seen):
        if seen is not None:
            symbol, begin, length = seen
            found[symbol].append((begin, length))

    for at in range(1, len(samples)):
        scl, sda = samples[at] & 1, samples[at] >> 1
        was_scl, was_sda = samples[at - 1] & 1, samples[at - 1] >> 1
        if scl and not was_scl:
            if sda != was_sda:
                first, last = at if first is None else first, at
            if fall is not None:
                found["tLOW"].append((fall, at - fall))
            busy = condition == "start"
            if last is not None and busy:
                found["tSU;DAT"].append((last, at - last))
                if fall is not None:
                    found["tHD;DAT"].append((fall, first - fall))
                    symbol = "tVD;ACK" if number % 9 == 8 else "tVD;DAT"
                    held_bit = (symbol, fall, last - fall)
            number += 1
            rise, in_high = at, False
        elif was_scl and not scl:
            if not in_high:
                low_is_before_a_bit(held_bit)
            if rise is not None and not in_high:
                found["tHIGH"].append((rise, at - rise))
                if fall is not None:
                    found["fSCL"].append((fall, at - fall))
            if hold is not None:
                found["tHD;STA"].append((hold, at - hold))
            hold = held_bit = None
            fall, first, last = at, None, None
            if sda != was_sda:
                first = last = at
        elif sda != was_sda and not scl:
            first, last = at if first is None else first, at
        elif sda != was_sda:
            after_rise = rise is not None and not in_high and (condition_at is None or rise > condition_at)
            if sda:
                if after_rise:
                    found["tSU;STO"].append((rise, at - rise))
                hold = None
            else:
                if condition == "start" and after_rise:
                    found["tSU;STA"].append((rise, at - rise))
                if condition == "stop":
                    found["tBUF"].append((condition_at, at - condition_at))
                hold = at
            condition, condition_at, in_high, number = ("stop" if sda else "start"), at, True, 0
    if not in_high and held_bit is not None:
        low_is_before_a_bit(held_bit)
    return dict(found)


@given(SAMPLES)
def test_times_of_random_lines_agree_with_a_simple_loop(samples):
    found = times(measured(of_bytes(samples, ("SCL", "SDA"))))
    assert found == walked(samples)


@given(SAMPLES, st.data())
def test_an_unknown_span_divides_the_trace(samples, data):
    """The measured times are those of the two parts."""
    cut = data.draw(st.integers(0, len(samples)))
    gap = data.draw(st.integers(1, 5))
    drawing = "\n".join(
        f"{name} "
        + "".join("_-"[s >> bit & 1] for s in samples[:cut])
        + "?" * gap
        + "".join("_-"[s >> bit & 1] for s in samples[cut:])
        for bit, name in enumerate(("SCL", "SDA"))
    )
    found = times(measured(drawn(drawing)))
    expected = defaultdict(list)
    for part, offset in ((samples[:cut], 0), (samples[cut:], cut + gap)):
        for symbol, seen in walked(part).items():
            expected[symbol] += [(begin + offset, length) for begin, length in seen]
    assert found == dict(expected)


FAST = EASY[Mode.FAST]


@pytest.mark.parametrize(
    ("line", "after", "length", "fails"),
    [
        ("SCL", 300, 50, []),  # a spike in the high phase
        ("SCL", 300, 51, ["tSP"]),
        ("SCL", 300, 100, ["tSP"]),
        ("SCL", 300, 101, ["fSCL", "tLOW", "tHIGH"]),  # not a spike any more, but a clock that is too short
        ("SDA", 300, 50, []),
        ("SDA", 300, 51, ["tSP"]),
        ("SCL", 1_300, 50, []),  # low phase
        ("SCL", 1_300, 51, ["tSP"]),
    ],
)
def test_the_judgement_of_a_spike_depends_on_its_length(line, after, length, fails):
    """The spike is after the fourth rise of SCL, which is high for 900 ns."""
    report = check(bus_drawn(FAST.but(spike=Spike(line, 3, after, length))), "SCL", "SDA", Mode.FAST)
    assert report.symbols_with(Verdict.FAIL) == fails
    assert report.row("tSP").count == (length <= 100)


def test_sda_can_change_several_times_while_scl_is_low():
    """A pulse of 51 ns is not a spike there, because SDA may pass from one party to the other. A pulse of 50 ns is a
    spike and does not affect the set-up time.
    """
    easy = check(bus_drawn(FAST), "SCL", "SDA", Mode.FAST).row("tSU;DAT")
    for length, count in ((50, 1), (51, 0)):
        report = check(bus_drawn(FAST.but(spike=Spike("SDA", 3, 900 + 1_000, length))), "SCL", "SDA", Mode.FAST)
        assert report.row("tSP").count == count
        assert report.row("tSU;DAT").count == easy.count + 1 - count, "this is the only change in this low phase"


def test_standard_mode_has_no_limit_for_spikes():
    bus = EASY[Mode.STANDARD].but(spike=Spike("SCL", 3, 2_000, 30))
    report = check(bus_drawn(bus), "SCL", "SDA", Mode.STANDARD)
    assert report.symbols_with(Verdict.FAIL) == ["fSCL", "tLOW", "tHIGH"]
    assert report.row("tSP").verdict is Verdict.NO_LIMIT


@pytest.mark.parametrize(("length", "verdict"), [(30, Verdict.PASS), (45, Verdict.UNDECIDABLE), (70, Verdict.FAIL)])
def test_a_spike_within_10_ns_of_the_limit_is_undecidable_at_100_mhz(length, verdict):
    capture = sampled(bus_drawn(FAST.but(spike=Spike("SCL", 3, 300, length))), 100 * 10**6)
    assert check(capture, "SCL", "SDA", Mode.FAST).row("tSP").verdict is verdict


def test_one_low_sample_at_4_mhz_can_be_a_spike_and_fails_no_clock():
    """It is certainly shorter than tLOW, but a spike is allowed to be."""
    capture = sampled(bus_drawn(FAST.but(spike=Spike("SCL", 3, 400, 40))), 4 * 10**6, phase=60)
    shortest = check(capture, "SCL", "SDA", Mode.FAST).row("tLOW")
    assert (shortest.least, shortest.verdict) == (1, Verdict.UNDECIDABLE)


def test_a_slow_capture_without_spikes_cannot_exclude_them():
    assert check(sampled(bus_drawn(FAST), 4 * 10**6), "SCL", "SDA", Mode.FAST).row("tSP").verdict is Verdict.UNDECIDABLE
    assert check(sampled(bus_drawn(FAST), 100 * 10**6), "SCL", "SDA", Mode.FAST).row("tSP").verdict is Verdict.NOT_SEEN
