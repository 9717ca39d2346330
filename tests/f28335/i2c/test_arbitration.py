"""I2C master: arbitration between two masters, and the loser's behaviour. SPRUG03B section 2.8, Table 10 (AL)."""

from __future__ import annotations

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from periph_sim.f28335.i2c.options import I2cOptions

from ..i2c_bus import SCL, SDA, SLOT, Bench, Foreign, Target, with_
from ..i2c_registers import FLAGS

rule = pytest.mark.rule


def go(b: Bench, data: list[int], extra: str = "STP") -> None:
    """Start a transfer of the module under test; partners with at=None start at the same time."""
    b.mode("MST TRX STT " + extra, count=len(data), data=data[0])


def lost(b: Bench) -> Bench:
    """Return a bench whose module has just lost arbitration in the address byte to a foreign master."""
    go(b, [1])
    b.until(lambda: b.flag("AL"))
    return b


@rule("I2C-176", "I2C-177", "I2C-178", "I2C-180", "I2C-257", "I2C-259", "I2C-260")
def test_the_module_loses_to_a_lower_address_in_the_bit_that_differs():
    b = Bench(Target(0x48), Foreign("S 48W 77 P", at=None))
    go(b, [1])
    rise = b.edge(SCL, 1, 3)  # 101.... and 100.... differ in the third bit
    assert b.flags("AL MST STP") == "MST STP" or rise == b.now
    b.until(lambda: b.flag("AL"), SLOT // 2)
    assert b.flags("AL MST STP") == "AL"
    assert b.m.out & 1 << SDA
    assert b.decoded_after(40 * SLOT) == "S 48W A 77 A P"
    assert (b.target.got, b.foreign.lost, b.foreign.acknowledges) == ([0x77], False, "AA")
    assert b.m.out == 0b11


@rule("I2C-177", "I2C-178")
def test_the_module_wins_with_a_lower_address_and_is_undisturbed():
    b = Bench(Target(0x50), Foreign("S 58W 77 P", at=None))
    go(b, [0x12])
    assert b.decoded_at_stop() == "S 50W A 12 A P"
    assert b.foreign.lost and b.target.got == [0x12]
    assert b.flags("AL") == ""


@rule("I2C-176", "I2C-178", "I2C-179", "I2C-257")
@settings(max_examples=25, deadline=None)
@given(st.integers(0, 255), st.integers(0, 255))
def test_with_equal_addresses_the_lower_data_byte_wins(mine: int, other: int):
    b = Bench(Target(0x50), Foreign(f"S 50W 33 {other:02x} P", at=None))
    b.mode("MST TRX STT STP", count=2)
    b.w("I2CDXR", 0x33)
    b.until(lambda: b.flag("XRDY"))
    b.w("I2CDXR", mine)
    b.run(35 * SLOT)
    assert b.target.got == [0x33, min(mine, other)]
    assert b.decoded() == f"S 50W A 33 A {min(mine, other):02x} A P"
    assert b.flag("AL") == (mine > other)
    assert b.foreign.lost == (other > mine)


@rule("I2C-176", "I2C-178", "I2C-179", "I2C-180", "I2C-257", "I2C-259")
@pytest.mark.parametrize("first, second", [(0x21, 0x22), (0x50, 0x10), (0x7, 0x70)])
def test_of_two_modules_the_lower_address_wins(first: int, second: int):
    targets = [Target(first), Target(second)]
    b = Bench(*targets, second=I2cOptions())
    for chip, address in ((b.m, first), (b.s, second)):
        b.w("I2CSAR", address, chip)
        b.w("I2CCNT", 1, chip)
        b.w("I2CDXR", address ^ 0x55, chip)
    for chip in (b.m, b.s):
        b.mode("MST TRX STT STP", chip=chip)
    b.run(40 * SLOT)
    low = min(first, second)
    assert b.decoded() == f"S {low:02x}W A {low ^ 0x55:02x} A P"
    assert (b.flag("AL", b.m), b.flag("AL", b.s)) == (int(first > second), int(second > first))


@rule("I2C-178")
def test_a_write_wins_over_a_read_of_the_same_address():
    b = Bench(Target(0x50, [0x99]), Foreign("S 50W 12 P", at=None))
    b.mode("MST STT STP", count=1)
    assert b.decoded_after(40 * SLOT) == "S 50W A 12 A P"
    assert b.flags("AL MST") == "AL"


@rule("I2C-261")
@pytest.mark.parametrize("own", [0x48, 0x49])
def test_the_loser_is_a_slave_receiver_and_answers_its_address(own: int):
    b = Bench(Foreign("S 48W 77 P", at=None), own=own)
    lost(b)
    assert b.flags("SDIR MST") == ""
    b.run(40 * SLOT)
    if own == 0x48:
        assert b.foreign.acknowledges == "AA"
        assert b.r("I2CDRR") == 0x77
    else:
        assert b.foreign.acknowledges == "NN"
        assert not b.flag("RRDY")


@rule("I2C-261")
def test_the_loser_of_a_data_byte_is_a_slave_that_is_not_addressed():
    b = Bench(Target(0x50), Foreign("S 50W 12 34 P", at=None), own=0x48)
    go(b, [0x13])
    assert b.decoded_after(50 * SLOT) == "S 50W A 12 A 34 A P"
    assert b.flags("AL MST AAS RRDY") == "AL"


@rule("I2C-180")
def test_the_loser_makes_no_clock_pulses_of_its_own_after_the_byte():
    """The low and high periods are those of the slower foreign master, not those of the module."""
    b = lost(Bench(Target(0x48), Foreign("S 48W 77 P", at=None, low=900, high=800)))
    b.edge(SCL, 0, 8)
    fall, rise, fall2 = b.edge(SCL, 0), b.edge(SCL, 1), b.edge(SCL, 0)
    assert (rise - fall, fall2 - rise) == (900, 800)


@rule("I2C-258", "I2C-259", "I2C-260")
def test_a_start_command_during_a_foreign_transfer_loses_at_once():
    b = Bench(Target(0x48), Target(0x50), Foreign("S 48W 77 P"))
    b.until(lambda: b.flag("BB"))
    b.edge(SCL, 0, 2)
    go(b, [1])
    b.until(lambda: b.flag("AL"), SLOT)
    assert b.flags("MST STP") == ""
    assert b.decoded_after(40 * SLOT) == "S 48W A 77 A P"


@rule("I2C-150", "I2C-176")
def test_a_start_command_of_the_loser_waits_for_the_stop_of_the_winner():
    b = lost(
        Bench(Target(0x48), Target(0x50), Foreign("S 48W 77 P", at=None), options=with_(stt_while_busy="foreign_waits"))
    )
    go(b, [0x12])
    assert b.decoded_after(60 * SLOT) == "S 48W A 77 A P S 50W A 12 A P"


@rule("I2C-262", "I2C-263", "I2C-264")
@pytest.mark.parametrize("how", ["write 1", "write 0", "read I2CISRC", "IRS"])
def test_al_is_cleared(how: str):
    b = Bench(Target(0x48), Foreign("S 48W 77 P", at=None))
    b.w("I2CIER", 1)
    lost(b)
    b.run(50)
    if how == "write 1":
        b.w("I2CSTR", FLAGS["AL"])
    elif how == "write 0":
        b.w("I2CSTR", 0)
    elif how == "read I2CISRC":
        assert b.r("I2CISRC") == 1
    else:
        b.w("I2CMDR", 0)
    assert b.flag("AL") == (how == "write 0")


@rule("I2C-263")
def test_another_code_in_i2cisrc_leaves_al():
    b = Bench(Target(0x48), Foreign("S 48W 77 P", at=None))
    lost(b)
    b.w("I2CSTR", 0)
    b.w("I2CIER", 1 << 5)
    b.until(lambda: b.flag("SCD"))
    b.run(50)
    assert b.r("I2CISRC") == 6
    assert b.flag("AL")


@rule("I2C-257")
def test_al_is_not_set_when_the_slave_answers():
    b = Bench(Target(0x50, [0x00]))
    b.read_all(1)
    b.write_all([0xFF])
    assert not b.flag("AL")


@rule("I2C-181", "I2C-179")
@pytest.mark.parametrize("mine, other, wins", [(0x58, 0x48, 0x48), (0x48, 0x58, 0x48)])
def test_arbitration_continues_after_a_simultaneous_repeated_start(mine: int, other: int, wins: int):
    b = Bench(Target(0x50), Target(wins), Foreign(f"S 50W 33 S {other:02x}W 77 P", at=None))
    go(b, [0x33], "")
    b.until(lambda: b.flag("ARDY"))
    assert not b.foreign.lost
    b.w("I2CSAR", mine)
    go(b, [0x66])
    assert b.decoded_after(40 * SLOT) == f"S 50W A 33 A S {wins:02x}W A {0x66 if mine == wins else 0x77:02x} A P"
    assert (b.flag("AL"), b.foreign.lost) == (int(mine != wins), mine == wins)


@rule("I2C-176", "I2C-258")
@pytest.mark.parametrize("before, joined", [(1, True), (14, True), (15, False), (16, False), (200, False)])
def test_a_start_of_another_master_within_the_filter_delay_leads_to_arbitration(before: int, joined: bool):
    """The START of the module is a module clock after STT; the other START is `before` cycles earlier."""
    b = Bench(Target(0x50), Target(0x58))
    b.w("I2CCNT", 1)
    b.w("I2CDXR", 0x12)
    foreign = Foreign("S 58W 77 P", at=b.now + 300 - before)
    b.join(foreign)
    b.run(300 - 15)
    b.mode("MST TRX STT STP")
    assert b.decoded_after(40 * SLOT) == ("S 50W A 12 A P" if joined else "S 58W A 77 A P")
    assert (foreign.lost, bool(b.flag("AL"))) == (joined, not joined)


@rule("I2C-172", "I2C-173", "I2C-176", "I2C-179", "I2C-180", "I2C-258")
@settings(max_examples=60, deadline=None)
@given(
    st.integers(0, 400),
    st.tuples(st.integers(6, 30), st.integers(1, 30)),
    st.tuples(st.sampled_from([0x21, 0x22, 0x50]), st.lists(st.integers(0, 255), min_size=1, max_size=3)),
    st.tuples(st.sampled_from([0x21, 0x22, 0x50]), st.lists(st.integers(0, 255), min_size=1, max_size=3)),
)
def test_the_transfer_of_the_winner_is_complete_with_any_clocks_and_start_times(
    later: int, clock: tuple[int, int], first: tuple[int, list[int]], second: tuple[int, list[int]]
):
    """`later`: cycles between the two commands; `clock`: clock divisors of the second module."""
    shorter = min(len(first[1]), len(second[1]))
    assume(first == second or (first[0], first[1][:shorter]) != (second[0], second[1][:shorter]))  # I2C-181
    targets = {a: Target(a) for a in (0x21, 0x22, 0x50)}
    b = Bench(*targets.values(), second=I2cOptions())
    b.w("I2CCLKL", clock[0], b.s)
    b.w("I2CCLKH", clock[1], b.s)
    jobs = [(b.m, *first, list(first[1])), (b.s, *second, list(second[1]))]
    for n, (chip, address, data, _) in enumerate(jobs):
        b.run(later * n)
        b.w("I2CSAR", address, chip)
        b.w("I2CCNT", len(data), chip)
        b.mode("MST TRX STT STP", chip=chip)
    quiet = 0
    while quiet < 20 * SLOT:
        before = len(b.edges)
        for chip, _, _, left in jobs:
            if b.flag("MST", chip) and b.flag("XRDY", chip) and left:
                b.w("I2CDXR", left.pop(0), chip)
        b.run(40)
        quiet = quiet + 40 if len(b.edges) == before else 0
    assert b.level == [1, 1]
    winners = [(address, data) for chip, address, data, _ in jobs if not b.flag("AL", chip)]
    assert winners
    assert all(not b.flag("MST", chip) for chip, *_ in jobs)
    for address, data in winners:
        text = f"S {address:02x}W A " + "".join(f"{d:02x} A " for d in data) + "P"
        assert text in b.decoded()
        assert data in (targets[address].got, targets[address].got[: len(data)], targets[address].got[-len(data) :])
