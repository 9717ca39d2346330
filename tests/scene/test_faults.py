"""Faults of a case in its scene: effects of spikes, held lines and resets on the emulator and the sensor head."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim import BadCase, Scene, load
from tests.scene.runs import Ran, run_file
from tests.scene.small import sentence_of

CASE = "imu_hil_published"


def faulty(fault: str, *changes: str, seconds: str = "0.1") -> Ran:
    return run_file(CASE, seconds, f"fault=[{fault}]", *changes)


def test_spikes_that_the_noise_filter_removes_change_no_byte():
    """A module clock is 100 ns. The spikes hit the emulator and the head at every phase of a bit."""
    plain = run_file(CASE, "0.1")
    for wire in ("SCL", "SDA"):
        ran = faulty(f'{{kind="spike", wire="{wire}", at="1 ms", every="37 us", spread="36 us", width="40 ns"}}')
        assert ran.read() == plain.read() and ran.broken() == []


def test_a_spike_on_scl_that_outlasts_the_filter_costs_a_read_and_no_more():
    """1 us in the gyroscope's first data byte: the emulator counts an extra clock, takes a 1 for a NACK, and ends."""
    ran = faulty('{kind="spike", wire="SCL", at="45.296 ms", width="1 us"}')
    plain = run_file(CASE, "0.1")
    assert [n for n in range(5) if ran.read()[n] != plain.read()[n]] == [2]
    assert ran.read()[2][0] == "01 ff ff ff ff ff" and ran.read()[2][1:] == plain.read()[2][1:]
    assert ran.answered() == ["GAM"] * 5


def test_a_slave_that_lost_count_holds_sda_until_the_head_clears_the_bus():
    """After an extra clock in the pointer byte, the emulator ends its ACK late, as the head sends a repeated START."""
    fault = '{kind="spike", wire="SCL", at="45.111 ms", width="1 us"}'
    hung = faulty(fault)
    assert hung.answered() == ["GAM", "GAM"] and "SDA is held low by dsp.GPIO32" in hung.result.stuck[0]
    cleared = faulty(fault, "controller.clear_after=1 ms")
    assert cleared.answered() == ["GAM", "GAM", "---", "-AM", "GAM"] and cleared.result.stuck == []


def test_sda_that_another_device_holds_is_free_again_after_nine_clocks():
    """The emulator acknowledges nine zeros after a START as a general call, and releases SDA at the attempted STOP."""
    fault = '{kind="hold", wire="SDA", at="20 ms", clocks=9}'
    ran = faulty(fault, "controller.clear_after=1 ms")
    assert ran.answered() == ["GAM"] * 5 and ran.read() == run_file(CASE, "0.1").read()
    late = [transfers[0].phases[0].start_at / 3e6 % 20 - 5 for transfers in ran.rounds]  # ms after they were due
    assert late[1] == pytest.approx(1 + 0.1, abs=0.02) and late[0] == late[2] == 0


def test_a_unit_in_reset_releases_the_bus_and_answers_again_after_its_start_up():
    """The reset comes in the gyroscope's data, with SDA low. The PLL needs 131072 clocks of 30 MHz to lock."""
    ran = faulty('{kind="reset", unit="dsp", at="5.46 ms", length="100 us"}')
    assert ran.result.counts["resets"] == 1
    assert ran.answered() == ["G--", "GAM", "GAM", "GAM", "GAM"]
    gyroscope = bytes.fromhex(ran.read()[0][0])
    assert gyroscope[-1] == 0xFF and ran.scene.wires["SDA"].held_by() == []
    starts = [first[0].phases[0].start_at for first in ran.rounds]
    assert [Fraction(at, 3 * 10**9) for at in starts] == [Fraction(5 + 20 * n, 1000) for n in range(5)]


def test_a_reset_that_ends_a_wait_removes_its_watchers():
    fault = '{kind="reset", unit="dsp", at="25.2 ms", every="10 ms", length="100 us"}'
    ran, plain = faulty(fault), run_file(CASE, "0.1")
    assert ran.result.counts["resets"] == 8
    for name, socket in ran.scene.units["dsp"].sockets.items():
        assert len(socket.watchers) <= len(plain.scene.units["dsp"].sockets[name].watchers) + 1, name


def test_frames_after_a_reset_are_whole_and_in_time():
    ran = faulty('{kind="reset", unit="dsp", at="25.46 ms", length="1 ms"}', seconds="0.2")
    assert ran.answered()[2:] == ["GAM"] * 8
    plain = run_file(CASE, "0.2")
    assert ran.read()[3:] == plain.read()[3:]


@pytest.mark.parametrize(
    ("at", "rounds", "first", "stuck"),
    [
        ("5.05 ms", ["---", "GAM"], "", ""),  # in the address: no ACK, and the firmware keeps waiting
        ("5.13 ms", [], "", "RRDY"),  # in the pointer byte: it is never received, and SCL is held with the next
        ("5.48 ms", ["GAM", "GAM"], "00 00 7f ff ff ff", ""),  # SDA is released; the STOP ends the wait for XRDY
    ],
)
def test_a_module_that_is_reset_in_mid_byte_releases_the_lines_and_clears_its_flags(
    at: str, rounds: list[str], first: str, stuck: str
):
    """The reset comes in the first request, whose data are zeros because no frame arrived before the models ran."""
    ran = faulty(f'{{kind="module_reset", unit="dsp", at="{at}"}}', seconds="0.05")
    assert ran.answered()[:2] == rounds
    assert not first or ran.read()[0][0] == first
    assert bool(ran.result.stuck) == bool(stuck) and stuck in "".join(ran.result.stuck)


def test_a_module_that_was_off_stays_so_after_its_reset():
    """The firmware has not set IRS when the run begins, so the fault does not set it again either."""
    ran = faulty('{kind="module_reset", unit="dsp", at="0 ms"}', seconds="0.05")
    plain = run_file(CASE, "0.05")
    assert ran.read() == plain.read() and ran.broken() == plain.broken() == []


def test_a_unit_without_i2c_has_no_module_to_reset():
    with pytest.raises(BadCase, match="unit dsp has no I2C-A that could be reset; add it to its modules"):
        run_file("uart_logger", "0.01", 'fault=[{kind="module_reset", unit="dsp", at="1 ms"}]')


@pytest.mark.parametrize(
    ("fault", "place", "sentence"),
    [
        ('{at="1 ms"}', "fault.0", "it has no kind; the kinds are condition, flip, hold, module_reset, reset, spike"),
        ('{kind="spik", at="1 ms"}', "fault.0.kind", "there is no fault 'spik'; did you mean spike?"),
        ('{kind="spike", at="1 ms", wire="SLC", width="1 us"}', "fault.0", "there is no wire 'SLC'; did you mean SCL?"),
        ('{kind="spike", at="1 ms", wire="SCL"}', "fault.0.width", "it is missing"),
        ('{kind="spike", at="1 ms", wire="SCL", wdith="1 us"}', "fault.0.wdith", "fault spike has no setting 'wdith'"),
        ('{kind="reset", at="1 ms", unit="dps"}', "fault.0", "there is no unit 'dps'; did you mean dsp?"),
        ('{kind="module_reset", at="1 ms", unit="dps"}', "fault.0", "there is no unit 'dps'; did you mean dsp?"),
        ('{kind="hold", at="1 ms", wire="SDA"}', "fault.0", "either for a length or for a number of clocks"),
    ],
)
def test_an_invalid_fault_is_reported_with_its_place(fault: str, place: str, sentence: str):
    message = sentence_of(BadCase, lambda: faulty(fault))
    assert f": {place}: " in message and sentence in message


def test_an_invalid_fault_of_a_file_is_reported_with_its_line(tmp_path: Path):
    path = tmp_path / "faulty.toml"
    path.write_text(
        'name = "faulty"\nduration = "1 ms"\n[controller]\norder = ["gyroscope"]\n'
        '[[fault]]\nkind = "spike"\nat = "1 ms"\nwire = "SCL"\nwidth = "0 us"\n',
        encoding="utf-8",
    )
    assert (
        sentence_of(BadCase, lambda: Scene(load(path, [])))
        == f"{path}, line 9: fault.0.width: it must be longer than 0, but it is '0 us'"
    )


@pytest.mark.parametrize(("at", "noted"), [("205.13 s", True), ("50 ms", False)])
def test_a_fault_after_the_end_of_the_run_is_noted(at: str, noted: bool):
    ran = faulty(f'{{kind="reset", unit="dsp", at="{at}", length="100 us"}}')
    note = "fault 0 (reset) never occurred: its time, 205.130000 s, is after the end of the run"
    assert (note in ran.result.notes) is noted
