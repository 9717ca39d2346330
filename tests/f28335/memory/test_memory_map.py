"""The address map: registers by address and by name, halves of wide registers, and addresses without a register."""

from __future__ import annotations

import pytest

from periph_sim.core.options import options_from
from periph_sim.f28335.memory.memory_map import (
    BOTH,
    HIGH,
    LOW,
    WORDS_MASK,
    AddressMap,
    Frame,
    WaitStates,
)
from periph_sim.f28335.system_options import SystemOptions
from tests.scene.test_addresses import everything


@pytest.fixture(scope="module")
def memory() -> AddressMap:
    return everything().memory


@pytest.mark.parametrize(
    ("name", "address"),
    [("I2C-A.I2CSTR", 0x7902), ("SCI-B.SCIRXBUF", 0x7757), ("GPIO.GPADAT", 0x6FC0), ("PIE.PIEACK", 0x0CE1)],
)
def test_a_register_by_name_is_the_one_at_its_address(memory: AddressMap, name: str, address: int) -> None:
    module, _, register = name.partition(".")
    place = memory.places[module]
    assert place.base + place.socket.chip.MAP[register].offset == address
    assert memory.at(address) == (place, place.socket.chip.MAP[register], 0)


def test_the_upper_half_of_a_wide_register_is_at_the_next_address(memory: AddressMap) -> None:
    place = memory.places["GPIO"]
    found = [(place, place.socket.chip.MAP["GPADAT"], half) for half in (0, 1)]
    assert [memory.at(0x6FC0), memory.at(0x6FC1)] == found


def test_the_masks_of_the_words_of_an_access_add_up_to_the_register() -> None:
    assert (WORDS_MASK[LOW], WORDS_MASK[HIGH]) == (0xFFFF, 0xFFFF << 16)
    assert BOTH == LOW | HIGH
    assert WORDS_MASK[BOTH] == 0xFFFF_FFFF


@pytest.mark.parametrize(
    ("address", "sentence"),
    [
        (
            0x790D,
            "0x790d is not a register of I2C-A (0x7900 to 0x793f); the nearest are I2CEMDR 0x790b and I2CPSC 0x790c",
        ),
        (0x78FF, "0x78ff belongs to no module of this scene, which has SYS 0x7010, "),
        (0x7940, "0x7940 belongs to no module of this scene"),
    ],
)
def test_an_address_without_a_register(memory: AddressMap, address: int, sentence: str) -> None:
    assert memory.at(address) is None
    assert str(memory.refusal(address)).startswith(sentence)


@pytest.mark.rule("SYS-034", "SYS-035")
def test_each_frame_has_its_own_wait_states() -> None:
    """Each pair is (reads, writes); those of frame 2 are options."""
    waits = WaitStates(options_from(SystemOptions, {"pf2_read_ws": 5, "pf2_write_ws": 7}))
    seen = {frame.name: (waits.read[frame], waits.write[frame]) for frame in Frame}
    assert seen == {"PF0": (1, 0), "PF1": (2, 0), "PF2": (5, 7)}
