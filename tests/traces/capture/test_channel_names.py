"""Channels found by what people call them: with scopes, in brackets, behind the name of a device."""

from __future__ import annotations

import pytest

from periph_sim.traces.capture.channel_names import channels_named
from tests.traces.decode.drawing import of_bytes


def found(line: str, *names: str) -> list[str]:
    return [channel.name for channel in channels_named(of_bytes(b"\0", names), line)]


@pytest.mark.parametrize("name", ["SCL", "scl ", "tb.bus.scl", "Channel 0 (SCL)", "24LC515 SCL", "i2c_scl", "SCL/A5"])
def test_a_channel_whose_name_has_the_line_as_a_word(name: str):
    assert found("scl", "D7", name) == [name]


@pytest.mark.parametrize("name", ["SCL2", "MISCL", "0", "SDA", "scl.enable"])
def test_a_channel_of_another_name(name: str):
    assert found("scl", name) == []


def test_the_name_itself_goes_before_a_word_and_two_words_are_two():
    assert found("rx", "RX", "RX ready") == ["RX"]
    assert found("rx", "host RX", "RX ready") == ["host RX", "RX ready"]
