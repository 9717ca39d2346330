"""Open questions about the SPI: one test for each option, run with each of its values.

A changed default or a changed meaning of a value makes a test fail.
"""

from __future__ import annotations

from itertools import pairwise

import pytest

from periph_sim.core.options import options_from
from periph_sim.f28335.spi.options import SpiOptions
from tests.f28335.open_questions import check_tests_of, keep
from tests.f28335.spi_rig import BIT, HALF, LSPCLK, MASTER, SLAVE, SpiRig

LOOP = {"SPICHAR": 3, "SPILBK": 1}


def rig_with(
    option: str, value: str | int | bool, setting: dict[str, int] = MASTER, fifo: bool = False, **fields: int
) -> SpiRig:
    return keep(option, SpiRig({option: value}, setting, fifo=fifo, **fields))


def selected(option: str, value: str | int | bool, **fields: int) -> SpiRig:
    """Return a rig of a slave whose SPISTE is low."""
    return rig_with(option, value, SLAVE, **fields).select_idle()


def test_every_option_has_a_test_with_every_value():
    check_tests_of(SpiOptions, __name__)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"start_pint": "bit_clock"}, "there is no option 'start_pint'; did you mean start_point"),
        ({"start_point": "now"}, "option start_point is 'now'; expected next_lspclk or bit_clock"),
        ({"input_latency": 17}, "option input_latency is 17; expected 0 to 16 SYSCLKOUT cycles"),
        ({"spirst_clears_fifos": 1}, "option spirst_clears_fifos is 1; expected true or false"),
    ],
)
def test_a_wrong_option_is_refused(given, text):
    with pytest.raises(ValueError, match=text):
        options_from(SpiOptions, given)


# Transfers of a master.


@pytest.mark.parametrize(("value", "starts"), [("next_lspclk", {1, 2, 3, 4}), ("bit_clock", set(range(1, 41)))])
def test_open_start_point(value, starts):
    waits, phases = set(), set()
    for cycle in range(40):
        rig = rig_with("start_point", value, SPIBRR=9)
        rig.wait(cycles=cycle)
        written = rig.now
        rig.send(0, 4)
        begun = rig.edges[1][0]
        waits.add(begun - written)
        phases.add(begun % 40)
    assert waits == starts
    assert len(phases) == (1 if value == "bit_clock" else 10)


@pytest.mark.rule("SPI-018")
@pytest.mark.parametrize(("value", "halves"), [("half_bit", 1), ("three_half_bits", 3)])
def test_open_ste_lead(value, halves):
    for phase in (0, 1):
        rig = rig_with("ste_lead", value, CLK_PHASE=phase)
        rig.pin(rig.now, SOMI=0)
        for word in (0, 0):  # the second word follows without another lead time
            rig.write("SPITXBUF", word)
        rig.wait(20)
        times = [time for time, _ in rig.edges]
        assert [after - before for before, after in pairwise(times[1:])] == ([halves * HALF] + [HALF] * (32 - phase))


@pytest.mark.rule("SPI-074")
@pytest.mark.parametrize("value", ["low", "high"])
def test_open_ste_in_txdly(value):
    rig_with("ste_in_txdly", value, fifo=True, SPICHAR=0, TXDLY=1).check(
        {
            "low": """
            > SPITXBUF  8  8 . . . . . . . .  .
            < CLK       0  1 0 . . 1 0 . . .  .
            < STE       0  . . . . . . 1 . .  .
        """,
            "high": """
            > SPITXBUF  8  8 . . . . . . . .  .
            < CLK       0  1 0 . . 1 0 . . .  .
            < STE       0  . 1 . 0 . . 1 . .  .
        """,
        }[value]
    )


@pytest.mark.rule("SPI-074")
@pytest.mark.parametrize(("value", "bits"), [("no_delay", 0), ("delay", 7)])
def test_open_txdly_first_word(value, bits):
    rig = rig_with("txdly_first_word", value, fifo=True, TXDLY=7)
    begin = rig.now
    rig.send(0x8000, 20)
    times = [time for time, levels in rig.edges if levels & 4]
    assert times[0] - begin == 1 + HALF + bits * BIT - (LSPCLK if bits else 0)


# Flags and interrupts.


@pytest.mark.rule("SPI-041")
@pytest.mark.parametrize(("value", "early"), [("trailing_edge", 0), ("latch_edge", 1)])
def test_open_int_flag_point(value, early):
    flags = []
    for phase in (0, 1):
        rig = rig_with("int_flag_point", value, **LOOP, CLK_PHASE=phase, SPIINTENA=1)
        begin = rig.now + 1
        rig.write("SPITXBUF", *(word << 12 for word in (5, 6)))
        rig.wait(10)
        flags.append([(at - begin) // HALF for at in rig.requested["RXINT"]])
        assert rig.flags("SPIRXBUF", "OVERRUN_FLAG") == {"SPIRXBUF": 6, "OVERRUN_FLAG": 1}
    assert flags == [[8], [8 - early]]


@pytest.mark.rule("SPI-044")
@pytest.mark.parametrize(("value", "requests"), [("flag_rises", 1), ("every_character", 3)])
def test_open_int_request(value, requests):
    rig = rig_with("int_request", value, **LOOP, SPIINTENA=1)
    for _ in range(3):
        rig.send(0x5000, 6)
    assert len(rig.requested["RXINT"]) == requests


@pytest.mark.rule("SPI-073")
@pytest.mark.parametrize(("value", "status"), [("stays_0", 0), ("follows", 0xC0)])
def test_open_status_in_fifo_mode(value, status):
    rig = rig_with("status_in_fifo_mode", value, fifo=True, **LOOP, SPIINTENA=1, OVERRUNINTENA=1)
    for _ in range(2):
        rig.send(0x5000, 6)
    assert (rig.peek("SPISTS"), rig.requested["RXINT"]) == (status, [])
    rig.set(SPIINTENA=0)
    rig.set(SPIINTENA=1)
    assert rig.requested["RXINT"] == []


@pytest.mark.rule("SPI-062", "SPI-067")
@pytest.mark.parametrize(("value", "flag"), [("level", 1), ("edge", 0)])
def test_open_fifo_int_mode(value, flag):
    rig = rig_with("fifo_int_mode", value, fifo=True, **LOOP, RXFFIL=1, RXFFIENA=1, TXFFIENA=1)
    rig.send(0x5000, 6)
    rig.set(TXFFINTCLR=1, RXFFINTCLR=1)
    assert rig.flags("TXFFINT", "RXFFINT") == {"TXFFINT": flag, "RXFFINT": flag}
    assert [len(rig.requested[line]) for line in ("TXINT", "RXINT")] == [1 + flag, 1 + flag]
    rig.read("SPIRXBUF")
    rig.set(RXFFINTCLR=1)
    rig.send(0x5000, 6)
    assert rig.get("RXFFINT") == 1  # the count reaches the level again


@pytest.mark.rule("SPI-072")
@pytest.mark.parametrize(("value", "requests"), [("rxffiena", 1), ("none", 0)])
def test_open_rxffovf_interrupt(value, requests):
    rig = rig_with("rxffovf_interrupt", value, fifo=True, **LOOP, RXFFIENA=1)
    for _ in range(17):
        rig.send(0x5000, 6)
    assert (rig.get("RXFFOVF"), len(rig.requested["RXINT"])) == (1, requests)


# Buffers.


@pytest.mark.rule("SPI-050")
@pytest.mark.parametrize(("value", "second"), [("replaces", 3), ("ignored", 2)])
def test_open_txbuf_write_when_full(value, second):
    rig = rig_with("txbuf_write_when_full", value, **LOOP)
    rig.write("SPITXBUF", *(word << 12 for word in (1, 2, 3)))
    assert rig.peek("SPITXBUF") == second << 12
    rig.wait(10)
    assert rig.show("SPIRXBUF") == second


@pytest.mark.rule("SPI-059")
@pytest.mark.parametrize(("value", "last"), [("ignored", 0), ("overwrites_last", 1)])
def test_open_txfifo_write_when_full(value, last):
    rig = rig_with("txfifo_write_when_full", value, fifo=True, **LOOP)
    rig.write("SPITXBUF", *((word & 0xF) << 12 for word in range(18)))
    rig.wait(18 * 4)
    assert rig.received(mask=0xF)[-2:] == [15, last]


@pytest.mark.rule("SPI-065")
@pytest.mark.parametrize(("value", "read"), [("last_word", 5), ("zero", 0)])
def test_open_rxfifo_read_when_empty(value, read):
    rig = rig_with("rxfifo_read_when_empty", value, fifo=True, **LOOP)
    rig.send(0x5000, 6)
    assert [rig.read("SPIRXBUF") & 0xF for _ in range(2)] == [5, read]


# Slave.


@pytest.mark.parametrize("value", [0, 3, 16])
def test_open_input_latency(value):
    """SPISOMI changes `value` cycles after an edge of SPICLK; SPISIMO is latched with its level at the edge."""
    rig = selected("input_latency", value)
    assert rig.chip.filter_width == value
    rig.send(0x8000, 4)
    begin = rig.now + 1
    rig.pin(begin, CLK=1)
    rig.wait(2)
    assert rig.edges[-1] == (begin + value, 0b1111)
    fall = rig.now + 1
    rig.pin(fall, CLK=0, SIMO=0)
    rig.pin(fall + 1, SIMO=1)
    rig.run_until(fall + value - 1)
    if value:
        assert rig.peek("SPIDAT") == 0x8000
    rig.run_until(fall + value + 1)
    assert rig.peek("SPIDAT") == 0


def test_with_a_latency_the_last_level_of_a_cycle_counts():
    rig = SpiRig({"input_latency": 2}, SLAVE)
    rig.pin(rig.now + 1, CLK=0)
    for levels in ({"STE": 0}, {"STE": 1}, {"STE": 0}):
        rig.pin(rig.now, **levels)
    rig.wait(1)
    assert rig.show("SOMI?") == 1
    assert [level for _, level in rig.edges] == [0b1111, 0b1101]


def test_with_a_latency_a_clock_pulse_within_a_cycle_is_ignored():
    rig = SpiRig({"input_latency": 2}, SLAVE).select_idle()
    begin = rig.now + 9
    rig.pin(begin, CLK=1)
    rig.pin(begin, CLK=0)
    rig.wait(2)
    assert rig.peek("SPIDAT") == 0


@pytest.mark.rule("SPI-022")
@pytest.mark.parametrize(("value", "came"), [("keeps_count", 0b1010_0101), ("restarts", 0b0101_1100)])
def test_open_ste_high_mid_character(value, came):
    rig = selected("ste_high_mid_character", value)
    rig.clock("1010")
    rig.select(False)
    rig.select()
    rig.clock("0101")
    if value == "restarts":
        assert rig.get("INT_FLAG") == 0
        rig.clock("1100")
    assert (rig.get("INT_FLAG"), rig.read("SPIRXBUF") & 0xFF) == (1, came)


@pytest.mark.parametrize(("value", "came"), [("keeps_count", 0b1000_0000), ("restarts", 0)])
def test_spiste_high_after_one_bit(value, came):
    rig = selected("ste_high_mid_character", value)
    rig.clock("1")
    rig.select(False)
    rig.select()
    rig.clock("0000000")
    assert (rig.get("INT_FLAG"), rig.peek("SPIRXBUF")) == (int(came > 0), came)


# Resets, debugger, clock gate.


@pytest.mark.rule("SPI-053", "SPI-076")
@pytest.mark.parametrize(("value", "kept"), [(False, 1), (True, 0)])
def test_open_swreset_clears_fifos(value, kept):
    assert fifos_after("swreset_clears_fifos", value, "SPISWRESET") == {
        "TXFFST": kept, "RXFFST": 16 * kept, "RXFFINT": kept, "RXFFOVF": kept,
    }  # fmt: skip


@pytest.mark.rule("SPI-076")
@pytest.mark.parametrize(("value", "kept"), [(True, 0), (False, 1)])
def test_open_spirst_clears_fifos(value, kept):
    assert fifos_after("spirst_clears_fifos", value, "SPIRST") == {
        "TXFFST": kept, "RXFFST": 16 * kept, "RXFFINT": kept, "RXFFOVF": kept,
    }  # fmt: skip


def fifos_after(option: str, value: bool, reset: str) -> dict[str, int]:
    """Return counts and flags after a reset bit was 0; before, TXFIFO had one word and RXFIFO had overflowed."""
    rig = rig_with(option, value, fifo=True, **LOOP, RXFFIL=1)
    for _ in range(17):
        rig.send(0x5000, 6)
    rig.write("SPITXBUF", *(0x5000 for _ in range(2)))
    rig.set(**{reset: 0})
    return rig.flags("TXFFST", "RXFFST", "RXFFINT", "RXFFOVF")


@pytest.mark.rule("SPI-079")
@pytest.mark.parametrize(("value", "bits"), [("whole_character", 3 + 8), ("remainder", 8)])
def test_open_bits_after_suspend(value, bits):
    rig = rig_with("bits_after_suspend", value)
    rig.send(0, 3.5)
    rig.chip.suspend(rig.now, True)
    rig.wait(5)
    rig.chip.suspend(rig.now, False)
    rig.wait(12)
    assert len([time for time, levels in rig.edges if levels & 0b100 and not levels & 0b1000]) == bits


@pytest.mark.rule("SPI-009")
@pytest.mark.parametrize("value", ["reads_0", "accessible"])
def test_open_clock_gate_access(value):
    rig = rig_with("clock_gate_access", value)
    rig.chip.gate(rig.now, False)
    rig.write("SPIBRR", 0x55)
    found = [rig.peek("SPIBRR"), rig.read("SPIBRR"), rig.chip.see(rig.now, 4)]
    assert found == ([0x55] * 3 if value == "accessible" else [3, 0, 0])
