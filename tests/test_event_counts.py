"""Cost of scenes in events. Counts are equal on every machine, so they detect a loss of speed, unlike times.

An I2C bit takes two events of the controller (SCL released, SCL falls) and two of each module that receives it through
its noise filter. An SCI bit takes none, because only its edges are events.
"""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.bus.uart.sender import UartSender
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from tests.scene.runs import TIMING, run_case, run_file
from tests.scene.small import case

BIT_8N1 = 4 * 8 * (40 + 1)  # SYSCLKOUT cycles: LSPCLK is a quarter, BRR 40
TICKS = 20  # ticks per cycle of 150 MHz


def i2c_events(
    request: dict[str, object], byte: str, modules: tuple[str, ...] = ("I2C-A",), disable: object = "bits"
) -> int:
    """Return the events of one transfer with a responder that polls and always answers with `byte`."""
    unit = {"firmware": "responder", "modules": modules, "settings": {"replies": [" ".join([byte] * 20)]}}
    head = {"first": "1 ms", "rounds": 1, "request": [{"address": 0x50, **request}]}
    ran = run_case(case(unit={"dsp": unit}, controller=head, disable=disable), "0.02")
    assert ran.result.verdict == "not judged" and ran.result.counts["nacked"] == 0
    return ran.result.events


SCL = 4 * 9  # nine bits: two edges of SCL per bit, and each edge leaves the filter of the module later
TWO_BITS = 4 * 2 + 1  # two of nine bits, and one event of the controller for skipping the other seven


@pytest.mark.parametrize(
    ("disable", "request_", "byte", "events"),
    [
        # The controller's ACK begins and ends: 2. The CPU sees XRDY and writes I2CDXR: 2. The module is not woken for
        # changes of SDA while SCL is low.
        *(("bits", "read", byte, SCL + 2 + 2) for byte in ("00", "ff", "55")),
        ("bits", "written", "ff", SCL + 1),  # the CPU sees RRDY and reads I2CDRR: 1
        (
            "bits",
            "written",
            "55",
            SCL + 1 + 8,
        ),  # eight changes of SDA, including the one before the ACK
        # The same with skipped bits; only the changes of SDA around the ACK remain.
        *(((), "read", byte, TWO_BITS + 2 + 2) for byte in ("00", "ff", "55")),
        ((), "written", "ff", TWO_BITS + 1),
        ((), "written", "55", TWO_BITS + 1 + 1),
    ],
)
@pytest.mark.parametrize("count", [2, 5, 16])
def test_an_i2c_byte_costs_this_number_of_events(disable: object, request_: str, byte: str, events: int, count: int):
    def total(length: int) -> int:
        if request_ == "read":
            return i2c_events({"count": length}, byte, disable=disable)
        return i2c_events({"count": 0, "write": " ".join([byte] * length)}, "00", disable=disable)

    assert total(count + 1) - total(count) == events


def sci_events(data: bytes, modules: list[str]) -> int:
    """Return the events of a burst at exactly the receiver's rate, which a polling loop reads from the FIFO.

    No code runs between accesses, so the firmware waits again before the next start bit.
    """
    unit = {"firmware": "uart_logger", "modules": modules, "code": {"between_accesses": 0}}
    scene = Scene(case(unit={"dsp": unit}))
    peer = UartSender(scene.kernel, scene.recorder, scene.wire("RX"), Fraction(BIT_8N1 * TICKS))
    scene.kernel.call_at(scene.timebase.ticks("1 ms"), lambda: peer.send(data, Fraction(0), lambda tick: None))
    return scene.run(Fraction(20, 1000)).events


@pytest.mark.parametrize(
    ("byte", "events"),
    [
        # 2 edges of start bit and stop bit; the module wakes once, at the end of the word, and the CPU once
        (0x00, 2 + 1 + 1),
        (0xFF, 2 + 1 + 1),
        (0x55, 10 + 1 + 1),  # ten bits, each of which begins with an edge
        (0x0F, 4 + 1 + 1),
    ],
)
@pytest.mark.parametrize("count", [1, 4, 11])
@pytest.mark.parametrize("modules", [["SCI-A"], ["SCI-A", "GPIO"]])
def test_an_sci_byte_costs_this_number_of_events(byte: int, events: int, count: int, modules: list[str]):
    assert sci_events(bytes([byte] * (count + 1)), modules) - sci_events(bytes([byte] * count), modules) == events


# Idle time costs no events --------------------------------------------------------


def per_round(name: str, period: str, seconds: str, *changes: str) -> Fraction:
    both = (f"controller.period={period}", f"host.period={period}")
    result = run_file(name, seconds, *both, *changes).result
    assert result.counts["rounds"] == 20
    return Fraction(result.events, 20)


@pytest.mark.parametrize("name", ["imu_hil_published", "wrong_order", "imu_hil_no_sdir"])
def test_a_round_every_2_s_costs_as_much_as_one_every_20_ms(name: str):
    often, seldom = per_round(name, "20 ms", "0.4"), per_round(name, "2 s", "40")
    assert abs(seldom - often) <= often / 10


def test_an_idle_hour_costs_no_events():
    once = ("controller.rounds=1", "host.frames=1")
    assert (
        run_file("imu_hil_published", "3600", *once).result.events
        == run_file("imu_hil_published", "0.02", *once).result.events
    )


@pytest.mark.parametrize("name", ["imu_hil_published", "two_dsps"])
@pytest.mark.parametrize("start", ["30 d", "12345.678 s"])
def test_a_round_after_30_days_has_the_cost_and_figures_of_the_first(name: str, start: str):
    first = run_file(name, "0.2").result
    late = run_file(name, "0.2", f"start={start}").result
    assert late.events == first.events
    assert late.budgets == first.budgets  # worst cases, counts, and instants relative to the start
    assert late.counts == first.counts


# Absent modules cost no events -------------------------------------------------


def imu_without(*modules: str) -> Scene:
    """Run the emulator with fixed data, no host and only these modules."""
    loaded = load(TIMING / "imu_hil_no_sdir.toml")
    unit = loaded.unit["dsp"].model_copy(update={"modules": modules, "pins": {}})
    scene = Scene(loaded.model_copy(update={"unit": {"dsp": unit}, "host": None}))
    scene.run(Fraction(1, 10))
    return scene


def test_without_sci_there_is_no_socket_wire_or_event_of_it():
    scene = imu_without("I2C-A")
    assert set(scene.units["dsp"].sockets) == {"SYS", "PIE", "I2C-A"}
    assert set(scene.wires) == {"SDA", "SCL"}
    assert scene.units["dsp"].router is None
    unused = imu_without("I2C-A", "SCI-A")
    assert set(unused.wires) == {"SDA", "SCL", "RX", "TX"}
    assert 0 <= unused.kernel.events - scene.kernel.events < 16  # only its set-up, since nothing is sent


def test_without_gpio_there_is_no_router_and_no_event_of_it():
    with_gpio = imu_without("I2C-A", "GPIO")
    without = imu_without("I2C-A")
    assert "GPIO" not in without.units["dsp"].sockets and "GPIO" in with_gpio.units["dsp"].sockets
    assert without.kernel.events < with_gpio.kernel.events


def test_a_module_that_is_idle_adds_nothing_to_an_i2c_byte():
    def cost(*modules: str) -> int:
        return i2c_events({"count": 9}, "55", modules) - i2c_events({"count": 8}, "55", modules)

    assert cost("I2C-A") == cost("I2C-A", "SCI-A", "SCI-B", "TIMER0", "TIMER1", "XINT")
