"""The cases of timing/ give the results that the dissertation describes, and show which byte is wrong, and why."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.firmware import sci_fifo_receiver
from periph_sim.imu.host_frames import encode, ramp
from periph_sim.processor.dsp import Dsp
from tests.scene.runs import run_file
from tests.scene.small import scene_with

TABLE = (
    'unit.dsp.settings.table={"0x68" = "11 12 13 14 15 16", "0x53" = "21 22 23 24 25 26", "0x1E" = "31 32 33 34 35 36"}'
)
RIGHT = ["11 12 13 14 15 16", "21 22 23 24 25 26", "31 32 33 34 35 36"]
SHIFTED = ["12 13 14 15 16 00", "22 23 24 25 26 00", "32 33 34 35 36 00"]
NO_HOST_CHECK = "controller.check=expect"


# imu_hil_published -------------------------------------------------------------


def test_imu_hil_published_keeps_every_budget():
    ran = run_file("imu_hil_published", "0.3")
    assert ran.result.verdict == "pass" and ran.broken() == []
    assert ran.answered() == ["GAM"] * 15
    assert ran.result.counts == {
        "rounds": 15,
        "missed": 0,
        "nacked": 0,
        "frames": 15,
        "stuck": 0,
        "overruns": 0,
        "polls_skipped": ran.result.counts["polls_skipped"],
        "resets": 0,
    }
    by_name = {verdict.name: verdict for verdict in ran.result.budgets}
    assert by_name["model execution"].worst == 250  # us; nothing interrupts it here
    assert by_name["wrong bytes"].count == 15 * 18
    assert by_name["SCI FIFO high-water"].worst == 12  # a frame
    assert ran.result.wire_bytes == 15 * 3 * (1 + 1 + 1 + 6)  # address, pointer, address, data
    assert ran.result.sci_bytes == 15 * 12


def test_imu_hil_published_reads_the_values_of_the_frame_that_had_come_before_the_models_ran():
    ran = run_file("imu_hil_published", "0.1")
    gyroscope, accelerometer, magnetometer = ran.read()[3]  # at 65 ms
    angles, accelerations = ramp(2)[:3], ramp(2)[3:]  # sent at 42 ms; the models ran after the round of 45 ms
    assert gyroscope == b"".join(v.to_bytes(2, "big", signed=True) for v in angles).hex(" ")
    assert accelerometer == b"".join(v.to_bytes(2, "little", signed=True) for v in accelerations).hex(" ")
    roll, pitch, yaw = angles
    assert magnetometer == b"".join(v.to_bytes(2, "big", signed=True) for v in (roll, yaw, pitch)).hex(" ")


# imu_hil_no_sdir ---------------------------------------------------------------


def test_without_the_sdir_wait_only_the_bytes_are_wrong():
    ran = run_file("imu_hil_no_sdir", "0.2")
    assert ran.broken() == ["wrong bytes"]
    assert ran.answered() == ["GAM"] * 10


def test_without_the_sdir_wait_the_controller_reads_everything_one_byte_early():
    """I2CDXR is written while the pointer byte's transfer still runs, so its first byte is gone before the read."""
    ran = run_file("imu_hil_no_sdir", "0.1")
    assert ran.read() == [SHIFTED] * 5
    chips = ("gyroscope", "accelerometer", "magnetometer")
    assert ran.result.wrong == {f"{chip} byte {i}": 5 for chip in chips for i in range(6)}
    assert run_file("imu_hil_no_sdir", "0.1", "unit.dsp.settings.sdir_wait=true").read() == [RIGHT] * 5


def test_a_shift_of_equal_bytes_is_visible_only_in_the_last_ones():
    """The shift leaves four of 0, 0, 0, 0, 0, 7 right: how many bytes are wrong depends on the data, not the cause."""
    table = 'unit.dsp.settings.table={"0x68" = "00 00 00 00 00 07"}'
    request = 'controller.request=[{chip = "gyroscope", expect = "00 00 00 00 00 07"}]'
    ran = run_file("imu_hil_no_sdir", "0.1", table, request, "unit.dsp.settings.order=[0x68]")
    assert ran.read() == [["00 00 00 00 07 00"]] * 5
    assert ran.result.wrong == {"gyroscope byte 4": 5, "gyroscope byte 5": 5}


# wrong_order -------------------------------------------------------------------


def test_wrong_order_serves_only_requests_to_the_address_that_is_set():
    """The controller asks A, G, M; the firmware serves G, A, M. A chip answers when it is next in both orders."""
    ran = run_file("wrong_order", "0.2")
    assert ran.answered() == ["-G-", "A-M"] * 5
    assert ran.result.counts["nacked"] == 15
    assert ran.broken() == ["nacked rounds", "nacked requests"]


def test_wrong_order_never_hangs():
    ran = run_file("wrong_order", "2")
    assert ran.answered() == ["-G-", "A-M"] * 50
    assert ran.result.stuck == []
    assert (ran.result.counts["missed"], ran.result.counts["stuck"]) == (0, 0)


def test_right_data_come_in_the_wrong_order_too():
    read = run_file("wrong_order", "0.1", TABLE, NO_HOST_CHECK).read()
    assert read == [["", RIGHT[0], ""], [RIGHT[1], "", RIGHT[2]]] * 2 + [["", RIGHT[0], ""]]


# late_model --------------------------------------------------------------------


def test_a_late_model_breaks_its_budget_and_loses_every_second_round():
    ran = run_file("late_model", "0.2")
    assert ran.broken() == ["model execution", "nacked rounds", "nacked requests", "data age"]
    assert ran.answered() == ["---", "GAM"] + ["--M", "GAM"] * 4
    by_name = {verdict.name: verdict for verdict in ran.result.budgets}
    assert by_name["nacked rounds"].worst == 5
    assert by_name["nacked requests"].worst == 3 + 4 * 2
    assert by_name["model execution"].worst > 18_000
    assert by_name["missed rounds"].worst == 0


def test_a_late_model_lets_the_last_address_answer_without_its_data():
    """0x1E is still in I2COAR: the module answers by itself with the contents of I2CDXR; IRS = 0 cuts that byte off."""
    rounds = run_file("late_model", "0.2", TABLE, NO_HOST_CHECK).read()
    assert rounds[1::2] == [RIGHT] * 5
    for gyroscope, accelerometer, magnetometer in rounds[2::2]:
        assert (gyroscope, accelerometer) == ("", "")
        assert magnetometer != RIGHT[2]
        assert magnetometer.endswith("ff ff ff ff ff")  # SDA is no longer driven


@pytest.mark.parametrize(("cost", "ok"), [("250 us", True), ("300 us", True), ("301 us", False), ("5 ms", False)])
def test_the_model_budget_passes_up_to_its_limit(cost: str, ok: bool):
    ran = run_file("late_model", "0.1", f"unit.dsp.settings.model_cost={cost}", "host.frames=0")
    assert ("model execution" not in ran.broken()) is ok


# The UART ----------------------------------------------------------------------


def test_one_lost_byte_shifts_every_later_frame():
    """Nothing in a frame marks its start: after a lost byte each FIFO interrupt takes parts of two frames."""
    ran = run_file("imu_hil_published", "0.4", "host.lose=[[3, 5]]")
    assert ran.broken() == ["wrong bytes", "data age"]
    sent = [encode(ramp(number)) for number in range(20)]
    sent[3] = sent[3][:5] + sent[3][6:]
    stream = b"".join(sent)
    taken = [bytes(12), *(stream[i : i + 12] for i in range(0, len(stream) - 11, 12))]
    accelerometers = [accelerometer for _, accelerometer, _ in ran.read()]
    # The models run at the end of a round, so round n shows what had arrived by the end of round n - 1. With a byte
    # missing, the interrupt of frame 3, and of every later frame, waits for the first byte of the next frame.
    assert accelerometers == [taken[n if n < 4 else n - 1][6:].hex(" ") for n in range(20)]


def test_without_a_lost_byte_nothing_is_shifted():
    assert run_file("imu_hil_published", "0.4", "host.lose=[]").broken() == []


def test_an_interrupt_that_is_never_served_overruns_the_fifo():
    def without_pie(dsp: Dsp) -> None:
        sci_fifo_receiver(dsp, 40, 12)  # asks for an interrupt, but PIE is off

    budget = {"name": "SCI overruns", "measure": "overruns", "max": 0}
    water = {"name": "water", "measure": "fifo high-water", "max": 16}
    again = budget | {"name": "the same again", "max": 40}  # it sees the same characters, which count once
    budgets = [budget, water, again]
    scene = scene_with(without_pie, ["SCI-A", "GPIO"], duration="60 ms", host={"baud": 115_200}, budget=budgets)
    result = scene.run()
    overruns, high, _ = result.budgets
    assert result.verdict == "fail" and overruns.verdict == "fail" and overruns.worst == 20
    assert result.counts["overruns"] == 20 and result.counts["frames"] == 3
    assert (high.worst, high.verdict) == (16, "not judged")  # most characters never entered the FIFO
    bit = Fraction(1, 115_200)
    seventeenth = Fraction(22, 1000) + 5 * 10 * bit  # frame 2 comes at 22 ms; 16 words fit, its fifth byte does not
    assert abs(overruns.at_s - float(seventeenth)) < float(bit)


@pytest.mark.parametrize("frames", [1, 2])
def test_frames_that_are_not_read_overrun_the_fifo_from_the_second_one(frames: int):
    scene = scene_with(
        lambda dsp: sci_fifo_receiver(dsp, 40, 12),
        ["SCI-A"],
        duration="60 ms",
        host={"baud": 115_200, "frames": frames},
        budget=[{"name": "SCI overruns", "measure": "overruns", "max": 0}],
    )
    assert scene.run().counts["overruns"] == (0, 8)[frames - 1]
