"""The emulator with three addresses read in any order, on GPIO pins and as three units, and robust to bus events."""

from __future__ import annotations

from itertools import permutations
from struct import pack
from typing import Any

import pytest

from periph_sim.core.records import Kind
from periph_sim.outside import Session
from periph_sim.outside.serial_line import SerialLine
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from tests.outside.sessions import BUS, Records, begun, case, refuses
from tests.profiles import explores
from tests.scene.runs import TIMING

GYROSCOPE, ACCELEROMETER, MAGNETOMETER = 0x68, 0x53, 0x1E
DATA_AT = {GYROSCOPE: 0x1D, ACCELEROMETER: 0x32, MAGNETOMETER: 0x03}
FRAMES = 300 if explores() else 4  # frames that come during reads
FORMS = {"pins": "imu_any_order", "units": "any_order_units"}


def emulator(form: str) -> tuple[Session, SerialLine]:
    """Return a session of a shipped case without head and host, after its models have run, and its serial line."""
    shipped = load(TIMING / f"{FORMS[form]}.toml")
    alone = shipped.model_copy(update={"host": None, "controller": None, "budget": ()})
    session = begun(alone, (*BUS, "RX"))
    return session, session.serial("SCI-A" if form == "pins" else "gyroscope.SCI-A")


def pins(**settings: object) -> Session:
    """Return the emulator on two GPIO pins; nothing is connected to its serial line."""
    return alone({"dsp": unit(["GPIO", "XINT"], **settings) | {"pins": {"SDA": 32, "SCL": 33}}})


def units() -> Session:
    """Return the same chips as three units."""
    return alone({f"chip{chip}": unit(["I2C-A"], bus="module", addresses=[chip]) for chip in DATA_AT})


ALONE = {"pins": pins, "units": units}


def alone(those: dict[str, dict[str, Any]]) -> Session:
    return begun(case(unit=those))


def unit(modules: list[str], **settings: object) -> dict[str, Any]:
    return {"firmware": case("imu_any_order").unit["dsp"].firmware, "modules": modules, "settings": settings}


def chips_of(frame: tuple[int, int, int, int, int, int]) -> dict[int, bytes]:
    """Return what the chips show after a frame: angles, accelerations, and angles with z before y."""
    roll, pitch, yaw, x, y, z = frame
    return {
        GYROSCOPE: pack(">3h", roll, pitch, yaw),
        ACCELEROMETER: pack("<3h", x, y, z),
        MAGNETOMETER: pack(">3h", roll, yaw, pitch),
    }


@pytest.mark.parametrize("form", FORMS)
def test_chips_are_read_in_any_order(form: str) -> None:
    session, line = emulator(form)
    frame = (100, -200, 300, -4, 5, -6)
    line.write(pack("<6h", *frame))
    session.advance(session.now + session.ticks("2 ms"))
    shown = chips_of(frame)
    for order in list(permutations(DATA_AT))[1::2]:
        for chip in order:
            assert session.i2c.transfer(chip, bytes([DATA_AT[chip]]), 6) == shown[chip]


def test_a_frame_with_a_damaged_character_is_ignored() -> None:
    session, line = emulator("pins")
    frames = [(1, 2, 3, 4, 5, 6), (7, 8, 9, 10, 11, 12), (13, 14, 15, 16, 17, 18)]
    seen = []
    for number, frame in enumerate(frames):
        data = pack("<6h", *frame)
        line.write(data[:4])
        line.write(data[4:5], wrong="stop" if number == 1 else "")
        line.write(data[5:])
        session.advance(session.now + session.ticks("2 ms"))
        seen.append(session.i2c.transfer(GYROSCOPE, b"\x1d", 6))
    assert seen == [chips_of(frames[kept])[GYROSCOPE] for kept in (0, 0, 2)]


def test_the_models_run_again_when_every_chip_was_read() -> None:
    """This keeps the noise changing when no frame comes."""
    records = Records()
    those = {"dsp": unit(["GPIO", "XINT"], model_cost="50 us") | {"pins": {"SDA": 32, "SCL": 33}}}
    session = begun(case(unit=those), subscribe=records.subscribe)

    def runs() -> int:
        session.advance(session.now + session.ticks("200 us"))
        return sum(record.kind is Kind.SPAN and record.value == 1 for record in records.kept)

    ran = []
    for chip in (GYROSCOPE, MAGNETOMETER, GYROSCOPE, ACCELEROMETER, MAGNETOMETER, ACCELEROMETER, *[GYROSCOPE] * 2):
        assert session.i2c.transfer(chip, bytes([DATA_AT[chip]]), 6) is not None
        ran.append(runs())
    for chip in (ACCELEROMETER, MAGNETOMETER):
        assert session.i2c.transfer(chip, b"\x3e\x01") == b""  # a write does not count as a read
    assert [*ran, runs()] == [1, 1, 1, 2, 2, 2, 3, 3, 3]


@pytest.mark.parametrize("before", ["nothing", "a write"])
def test_a_start_is_detected_although_scl_falls_before_it_is_sampled(before: str) -> None:
    """Both lines fall within 100 ns; the address follows at 100 kHz."""
    session = pins()
    master = session.i2c
    if before == "a write":
        assert master.transfer(MAGNETOMETER, b"\x0a") == b""
    session.apply(session.now, {"SDA": 0})
    session.apply(session.now + session.ticks("100 ns"), {"SCL": 0})
    session.advance(session.now + session.ticks("5 us"))
    bits = [int(bit) for bit in f"{ACCELEROMETER << 1:08b}"] + [1]
    seen = []
    for bit in bits:
        session.apply(session.now, {"SDA": bit})
        session.advance(session.now + session.ticks("3 us"))
        session.apply(session.now, {"SCL": 1})
        session.advance(session.now + session.ticks("5 us"))
        seen.append(session.level("SDA"))
        session.apply(session.now, {"SCL": 0})
        session.advance(session.now + session.ticks("2 us"))
    assert seen == [*bits[:8], 0]
    assert master.clear()


@pytest.mark.parametrize("rate", ["100 kHz", "400 kHz"])
def test_a_frame_during_a_read_does_not_mix_old_and_new_data(rate: str) -> None:
    """Frames follow each other without a pause, so that a service routine interrupts every read."""
    session, line = emulator("pins")
    session.i2c.rate = rate
    frames = [tuple(range(n, n + 6)) for n in range(0x100, 0x100 + FRAMES)]
    line.write(b"".join(pack("<6h", *frame) for frame in frames))
    possible = {chip: [chips_of((0,) * 6)[chip], *(chips_of(frame)[chip] for frame in frames)] for chip in DATA_AT}
    seen, last = 0, dict.fromkeys(DATA_AT, 0)
    while seen < len(frames) and session.now < session.ticks("1 ms") * (2 * FRAMES + 3):
        for chip, at in DATA_AT.items():
            got = session.i2c.transfer(chip, bytes([at]), 6)
            assert got is not None
            seen = possible[chip].index(got)
            assert seen >= last[chip], "the data are of an older frame than before"
            last[chip] = seen
    assert seen == len(frames)


@pytest.mark.parametrize("form", ALONE)
def test_other_addresses_are_not_acknowledged(form: str) -> None:
    """A module acknowledges the general call by itself (I2CSTR.AD0); the emulator on pins does not."""
    master = ALONE[form]().i2c
    for address in (0x52, 0x69, 0x7F):
        assert master.transfer(address, b"\x06") is None
        assert master.transfer(address, count=1) is None
    assert master.transfer(ACCELEROMETER, b"\x00") == b""
    assert master.transfer(0x00, b"\x06\x77") == (None if form == "pins" else b"")
    assert master.transfer(ACCELEROMETER, count=1) == b"\xe5"
    assert master.transfer(ACCELEROMETER, b"\x06", 1) == b"\x00"


@pytest.mark.parametrize("form", ALONE)
def test_registers_are_written_and_read_after_a_pointer(form: str) -> None:
    """S 53W 2C 0A 08 P   S 53W 2C Sr 53R 0A 08 00 P   S 53R 00 P   S 1EW 0A P   S 1ER 48 34 33 P"""
    master = ALONE[form]().i2c
    assert master.transfer(ACCELEROMETER, b"\x2c\x0a\x08") == b""
    assert master.transfer(ACCELEROMETER, b"\x2c", 3) == b"\x0a\x08\x00"
    assert master.transfer(ACCELEROMETER, b"\x2d", 1) == b"\x08"
    assert master.transfer(ACCELEROMETER, count=1) == b"\x00"
    assert master.transfer(MAGNETOMETER, b"\x0a") == b""
    assert master.transfer(MAGNETOMETER, count=3) == b"H43"


@pytest.mark.parametrize("number", [1, 7])
@pytest.mark.parametrize("ends", ["STOP", "repeated START"])
@pytest.mark.parametrize("form", ALONE)
def test_an_incomplete_byte_is_ignored(form: str, ends: str, number: int) -> None:
    """A transfer ends within an address, a written byte or a read byte; the next transfer is unaffected.

    Only the pointer of a module has advanced, which requests the next byte as soon as one is being sent.
    """
    master = ALONE[form]().i2c

    def broken_off() -> None:
        if ends == "STOP":
            master.stop()
        if form == "units":
            assert master.start(ACCELEROMETER) and master.write(0x00)
        assert master.start(ACCELEROMETER, read=True)
        assert master.read(ack=False) == 0xE5
        master.stop()

    master.start(0x50)  # no target has this address; all that follows is part of no transfer for the three
    master.start(ACCELEROMETER)
    master.write(0x00)
    master.bits(*[0, 1, 1, 0, 1, 0, 1][:number])
    broken_off()
    master.start(ACCELEROMETER)
    master.write(0x00)
    master.start(ACCELEROMETER, read=True)
    assert master.bits(1, 1) == [1, 1]  # of 0xE5; the third bit is 1 too, and then a 0 is driven
    broken_off()


@pytest.mark.parametrize("form", ALONE)
def test_clocks_free_the_bus_after_a_read_was_abandoned_at_a_0(form: str) -> None:
    """UM10204 section 3.1.16: the master was reset and released SDA; up to nine clocks free the bus."""
    session = ALONE[form]()
    master = session.i2c
    assert master.start(ACCELEROMETER, read=True)
    assert master.bits(1, 1, 1) == [1, 1, 1]
    refuses("STOP is impossible: SDA is low, held by another party", master.stop)
    assert session.pulls("SDA")
    assert master.clear()
    assert not session.pulls("SDA")
    assert master.transfer(ACCELEROMETER, b"\x00", 1) == b"\xe5"


def test_transfers_of_others_are_ignored() -> None:
    """A slave with an I2C module is on the bus too; its data look like addresses of the emulator."""
    other = {"firmware": case("register_slave").unit["dsp"].firmware, "modules": ["I2C-A"]}
    session = alone({"dsp": unit(["GPIO", "XINT"]) | {"pins": {"SDA": 32, "SCL": 33}}, "other": other})
    data = bytes([GYROSCOPE << 1, ACCELEROMETER << 1 | 1, 0x00, 0xFF])
    assert session.i2c.transfer(0x50, b"\x10" + data) == b""
    assert session.i2c.transfer(0x50, b"\x10", 4) == data
    assert session.i2c.transfer(ACCELEROMETER, b"\x00", 1) == b"\xe5"
    assert session.i2c.transfer(0x50, count=1) == b"\x00"


def test_scl_is_held_while_a_slow_target_works() -> None:
    """Code takes 6 us per byte at 400 kHz: an address, a written byte and a read byte are each longer by about that."""
    session = pins(costs={"byte": 900})
    session.i2c.rate = "400 kHz"
    began = session.now
    assert session.i2c.transfer(ACCELEROMETER, b"\x20\x5a") == b""
    assert session.now - began > session.ticks("18 us") + 27 * session.ticks("2.5 us")
    assert session.i2c.transfer(ACCELEROMETER, b"\x20", 2) == b"\x5a\x00"


def test_the_emulator_on_pins_holds_scl_for_less_than_a_bit_at_400_khz() -> None:
    """With code costs at 400 kHz, SCL is held at the end of a byte for less than a bit."""
    session = pins()
    session.i2c.rate = "400 kHz"
    began = session.now
    assert session.i2c.transfer(ACCELEROMETER, b"\x00", 6) == b"\xe5" + bytes(5)
    bare = session.ticks("2.5 us") * (9 * 9 + 3)
    assert session.now - began < bare + 9 * session.ticks("2.5 us")


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"addresses": [0x68, 0x20]}, "addresses has 0x20; the chips are at 0x68, 0x53 and 0x1e"),
        ({"bus": "module"}, "an I2C module has one own address, and addresses has 3"),
        ({"models_run": "round"}, "a round is undefined if any order is possible; leave models_run out"),
    ],
)
def test_impossible_settings_are_refused(settings: dict[str, object], message: str) -> None:
    refuses(message, pins, **settings, error=BadCase)
