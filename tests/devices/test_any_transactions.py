"""Random transactions, complete or cut anywhere: chips keep the bus protocol, and reads agree with a simple model.

The decoder checks the protocol; it shares no code with chips, targets and controller.
"""

from __future__ import annotations

from functools import partial

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.bus.i2c.transfer import Phase
from periph_sim.devices.chips.adxl345 import Adxl345
from periph_sim.devices.chips.hmc5883l import Hmc5883l
from periph_sim.devices.chips.itg3200 import Itg3200
from periph_sim.traces.decode import i2c
from tests.devices.bench import DELAY, TIMEBASE, US, Bench, steady
from tests.devices.oracles import AdxlOracle, HmcOracle, ItgOracle, Oracle

KEEP_QUIET = {"adxl345": (0x2D, 0x37), "itg3200": (0x3E, 0x00), "hmc5883l": (0x02, 0x02)}
# The register that starts measurements, and its bits that do not start any: writes to it are masked with these bits.


def world(name: str) -> tuple[Bench, Oracle]:
    if name == "adxl345":
        return Bench(Adxl345(TIMEBASE, steady(1, 1, 1))), AdxlOracle()
    if name == "hmc5883l":
        return Bench(Hmc5883l(TIMEBASE, steady(1, 1, 1))), HmcOracle()
    chip = Itg3200(TIMEBASE, steady(1, 1, 1))
    chip.write(0, 0x3E, 0x40)
    return Bench(chip), ItgOracle()


numbers = st.integers(0, 255) | st.sampled_from([0x00, 0x02, 0x07, 0x0B, 0x15, 0x1A, 0x20, 0x2C, 0x30, 0x36, 0x38])
transactions = st.one_of(
    st.tuples(st.just("write"), numbers, st.binary(max_size=4)),
    st.tuples(st.just("read"), numbers, st.integers(1, 8)),
    st.tuples(st.just("read by STOP"), numbers, st.integers(1, 8)),
    st.tuples(st.just("read on"), st.integers(1, 8)),
    st.tuples(st.just("address only")),
    st.tuples(st.just("another address"), st.binary(max_size=3)),
)


def quiet(name: str, number: int, data: bytes) -> bytes:
    """The data of a write, changed so that they do not start measurements (ITG-3200: do not wake the chip)."""
    register, bits = KEEP_QUIET[name]
    following = world(name)[1].following
    out = bytearray()
    for value in data:
        calm = value & bits | (0x40 if name == "itg3200" else 0x02 if name == "hmc5883l" else 0)
        out.append(calm if number == register else value)
        number = following(number)
    return bytes(out)


@pytest.mark.parametrize("name", KEEP_QUIET)
@settings(max_examples=40, deadline=None)
@given(st.lists(transactions, min_size=1, max_size=8))
def test_reads_agree_with_the_oracle_and_with_the_decoded_wires(name: str, sequence: list[tuple]):
    bench, oracle = world(name)
    own = bench.address
    expected: list[tuple[int, bool, bool, bytes]] = []  # phases: address, read, acknowledged, data
    for what, *given_ in sequence:
        if what == "another address":
            assert bench.transfer(Phase(own ^ 0x02, False, given_[0])).acked is False
            expected.append((own ^ 0x02, False, False, b""))
        elif what == "address only":
            assert bench.transfer(Phase(own, False)).acked
            expected.append((own, False, True, b""))
        elif what == "read on":
            data = bytes(oracle.read() for _ in range(given_[0]))
            assert bench.read_on(given_[0]) == data
            expected.append((own, True, True, data))
        elif what == "write":
            number, written = given_[0], quiet(name, *given_)
            assert bench.write(number, *written)
            oracle.set_pointer(number)
            for value in written:
                oracle.write(value)
            expected.append((own, False, True, bytes([number, *written])))
        else:
            number, count = given_
            oracle.set_pointer(number)
            data = bytes(oracle.read() for _ in range(count))
            assert bench.read(number, count, by_stop=what == "read by STOP") == data
            expected += [(own, False, True, bytes([number])), (own, True, True, data)]
    assert bench.scl.level == bench.sda.level == 1
    assert phases_of(bench.decoded()) == expected


def phases_of(transfers: list[i2c.Transfer]) -> list[tuple[int, bool, bool, bytes]]:
    """The decoded phases as (address, read, acknowledged, data).

    All must be complete: no byte is cut, ACKs are as expected, and each transfer ends with a STOP.
    """
    found = []
    for transfer in transfers:
        assert transfer.complete and not transfer.lead
        for phase in transfer.phases:
            first, *data = phase.bytes
            assert all(len(byte.bits) == 9 for byte in phase.bytes)
            acks = [byte.acked for byte in data]
            assert (
                acks == [True] * len(data)
                if not phase.read
                else acks == [True] * (len(data) - 1) + [False] * bool(data)
            )
            found.append((phase.address, bool(phase.read), bool(first.acked), bytes(phase.data)))
    return found


@pytest.mark.parametrize("name", KEEP_QUIET)
@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.booleans(), st.integers(0, 1)), max_size=120), st.integers(0, 2**16 - 1))
def test_after_random_edges_a_target_changes_sda_only_when_scl_fell_and_nine_pulses_free_the_bus(
    name: str, moves: list[tuple[bool, int]], bits: int
):
    bench, _ = world(name)
    kernel, scl, sda = bench.kernel, bench.scl, bench.sda
    hands = {True: scl.attach("hand"), False: sda.attach("hand")}
    chip = type(bench.chips[0]).__name__
    own = [bench.address << 1 | read for read in (0, 1)]
    address = [(False, 0), (True, 0)]  # START and the chip's address, which half of the examples begin with
    for bit in range(7, -1, -1):
        address += [(False, own[bits & 1] >> bit & 1), (True, 1), (True, 0)]

    def move(clock: bool, level: int) -> None:
        before = chip in sda.held_by()
        kernel.call_at(kernel.now + US, partial(hands[clock].drive, level))
        kernel.run_until(kernel.now + US + 2 * DELAY)
        if scl.level or not clock:
            assert (chip in sda.held_by()) is before, "the target changed SDA without a falling edge of SCL"

    for clock, level in [*(address if bits & 2 else []), *moves, (False, 1)]:
        move(clock, level)
    pulses = 0
    while not (scl.level and sda.level):
        move(True, 0)
        move(True, 1)
        pulses += 1
    assert pulses <= 9
    move(False, 0)  # START
    move(False, 1)  # and STOP
    assert sda.level == scl.level == 1
    bench.wait(10 * US)
    identity = {"adxl345": (0x00, b"\xe5"), "itg3200": (0x3E, None), "hmc5883l": (0x0A, b"H43")}[name]
    got = bench.read(identity[0], len(identity[1] or b"\0"))
    assert identity[1] is None or got == identity[1]
    assert bench.done[-1].acked
