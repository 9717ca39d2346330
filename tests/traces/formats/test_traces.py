"""The traces in the repository equal the output of their generator and have the contents described in their README."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.traces import formats
from periph_sim.traces.decode import i2c, uart
from tests.traces.formats.make_traces import FOLDER, FRAMES, ROUND, TRACES


@pytest.mark.parametrize("name", sorted(TRACES))
def test_a_file_equals_the_output_of_the_generator(name: str):
    content = (FOLDER / name).read_bytes()
    assert content == TRACES[name](), f"traces/{name} differs; run python -m tests.traces.formats.make_traces"
    assert len(content) < 20_000
    assert name in (FOLDER / "README.md").read_text()


def test_imu_round_is_three_register_reads_at_100_khz():
    capture = formats.read(FOLDER / "imu_round.sr")
    found = i2c.transfers(capture)
    assert [(phase.address, phase.read, phase.data) for transfer in found for phase in transfer.phases] == [
        entry
        for address, pointer, values in ROUND
        for entry in ((address, False, (pointer,)), (address, True, tuple(values)))
    ]
    bits = [bit for transfer in found for phase in transfer.phases for byte in phase.bytes for bit in byte.bits]
    assert {(bit.low, bit.high) for bit in bits} == {(20, 20)} and capture.rate == 4_000_000
    assert i2c.shared_edges(capture) == 0


def test_nack_is_two_refused_addresses_and_a_device_id():
    found = i2c.transfers(formats.read(FOLDER / "nack.sr"))
    assert [phase.bytes[0].acked for transfer in found for phase in transfer.phases] == [False, False, True, True]
    assert found[-1].phases[-1].data == (0xE5,)


def test_host_frames_are_two_frames_of_six_words():
    found = uart.events(formats.read(FOLDER / "host_frames.sr"), "RX", uart.Line(115200))
    frames = [event for event in found if event.kind.name == "FRAME"]
    assert len(frames) == len(found) == 24
    assert not any(frame.frame_error or frame.parity_error for frame in frames)
    content = bytes(frame.value for frame in frames)
    words = [int.from_bytes(content[n : n + 2], "little", signed=True) for n in range(0, 24, 2)]
    assert words == [word for frame in FRAMES for word in frame]
    assert frames[12].at - frames[0].at == 5000
    assert abs(frames[11].end - frames[0].at - 120 * Fraction(10**6, 115200)) < 2
