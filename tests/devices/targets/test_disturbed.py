"""Devices that stretch or are faulty: the bytes that are affected, the effect, and its dependence on the seed."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.scene.case.model import Case
from tests.devices.targets.bus_of import FAST, Bus
from tests.scene.runs import run_case

US = 1_000  # ticks
READ = "50 W 00 00 Sr 50 R 4"


def memory(**more: Any) -> Bus:
    return Bus(memory={"model": "24lc64", "contents": "11 22 33 44", **more})


def faulty(**fault: Any) -> Bus:
    return memory(fault=[fault])


@pytest.mark.parametrize(
    ("fault", "shown"),
    [
        ({"kind": "nack"}, "50!"),
        ({"kind": "nack", "bytes": [2]}, "50 00 00! Sr 50 11 22 33 44"),
        ({"kind": "nack", "access": "read", "bytes": [0]}, "50 00 00 Sr 50!"),
        ({"kind": "wrong", "value": 0xAA, "bytes": [2]}, "50 00 00 Sr 50 11 aa 33 44"),
        ({"kind": "flip", "bit": 7, "bytes": [1, 4]}, "50 00 00 Sr 50 91 22 33 c4"),
    ],
)
def test_faults_change_the_selected_bytes(fault: dict[str, Any], shown: str):
    assert faulty(**fault).do(READ) == shown


def test_a_refused_byte_is_not_stored():
    bus = faulty(kind="nack", access="write", bytes=[4])
    assert bus.do("50 W 00 00 aa bb") == "50 00 00 aa bb!"
    assert bus.scene.devices["memory"].target.memory[:2] == b"\xaa\x22"


def test_phases_are_counted_from_1_and_per_access():
    bus = faulty(kind="wrong", value=0, access="read", phases=[2])
    reads = [bus.do("50 W 00 00 Sr 50 R 1")[-2:] for _ in range(3)]
    assert reads == ["11", "00", "11"]


def test_a_fault_is_active_between_after_and_until():
    bus = faulty(kind="wrong", value=0, after="200 us", until="400 us")
    reads = []
    for _ in range(3):
        reads.append(bus.do("50 W 00 00 Sr 50 R 1")[-2:])
        bus.wait(100 * US)
    assert reads == ["11", "00", "11"]


@pytest.mark.parametrize(
    ("stretch", "of_write", "of_read"),
    [
        ("20 us", 20, 20),
        ({"length": "20 us", "access": "read"}, 0, 20),
        ({"length": "20 us", "bytes": [9]}, 0, 0),
        ({"length": "20 us", "phases": [2]}, 0, 20),
        ({"length": "1 us"}, 0, 0),  # SCL is low for 1.3 us anyway
    ],
)
def test_a_stretching_device_holds_scl(stretch: Any, of_write: int, of_read: int):
    bus = memory(stretch=stretch)
    assert bus.do(READ).endswith("11 22 33 44")
    own = FAST.low
    assert [phase.stretch for phase in bus.last.phases] == [max(0, us * US - own) for us in (of_write, of_read)]


def shares(seed: int) -> list[int]:
    stretch = {"length": "5 us to 20 us", "share": "25 %"}
    bus = Bus(seed=seed, memory={"model": "24lc64", "stretch": stretch})
    stretches = []
    for _ in range(20):
        bus.do("50 R 1")
        stretches.append(bus.last.phases[0].stretch)
    return stretches


def test_random_stretches_are_equal_in_every_run():
    first = shares(1)
    assert first == shares(1) != shares(2)
    struck = [stretch for stretch in first if stretch]
    assert 3 < len(struck) < 17 and len(set(struck)) > 2


def test_sda_is_held_for_a_number_of_clocks():
    bus = faulty(kind="hold", access="read", bytes=[2], clocks=4, phases=[1])
    assert bus.do(READ) == "50 00 00 Sr 50 11 02 33 44"  # 22 begins with 0010: its first four bits are 0 now
    assert bus.do(READ).endswith("11 22 33 44")


def test_sda_held_for_a_time_is_a_stuck_line():
    bus = faulty(kind="hold", access="read", bytes=[1], length="100 us")
    bus.do(READ)
    assert bus.last.phases[1].got[0] == 0


def test_without_power_a_device_releases_the_bus_and_does_not_acknowledge():
    bus = faulty(kind="off", after="100 us", until="300 us")
    assert bus.do(READ) == "50 00 00 Sr 50 3f ff ff ff"  # after two bits of 0x11, SDA is always high
    assert bus.do("50 W") == "50!"
    bus.wait(200 * US)
    assert bus.do(READ).endswith("11 22 33 44")


def test_registers_are_reset_by_a_loss_of_power():
    register = [{"name": "R", "at": 0, "reset": 1}]
    bus = Bus(
        it={
            "model": "registers",
            "address": 0x48,
            "register": register,
            "fault": [{"kind": "off", "after": "250 us", "until": "260 us"}],
        }
    )
    bus.do("48 W 00 77")
    assert bus.do("48 W 00 Sr 48 R 1").endswith("77")
    bus.wait(200 * US)
    assert bus.do("48 W 00 Sr 48 R 1").endswith("01")


CHIP = {
    "name": "chips",
    "duration": "10 ms",
    "chip": {"it": {"model": "hmc5883l", "values": {"fixed": [0, 0, 0]}}},
    "controller": {"first": "1 ms", "request": [{"address": 0x1E, "pointer": 0x0A, "count": 3, "expect": "48 34 33"}]},
    "budget": [
        {"name": "wrong", "measure": "wrong bytes", "max": 0},
        {"name": "stretch", "measure": "stretch", "max": "0 us"},
    ],
}


@pytest.mark.parametrize(
    ("disturbed", "broken"),
    [
        ({}, []),
        ({"fault": [{"kind": "flip", "bytes": [3]}]}, ["wrong"]),
        ({"stretch": "30 us"}, ["stretch"]),
    ],
)
def test_sensor_chips_have_the_same_disturbances(disturbed: dict[str, Any], broken: list[str]):
    chip = {"it": {**CHIP["chip"]["it"], **disturbed}}  # type: ignore[index,call-overload]
    assert run_case(Case.model_validate({**CHIP, "chip": chip}), "0.01").broken() == broken
