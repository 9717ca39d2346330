"""The emulator with its sensor models: the bytes on the bus are those of the models for the host's frames."""

from __future__ import annotations

from math import degrees
from struct import pack, unpack

import numpy as np
import pytest

from firmware.python.imu_models import NO_FRAME, Models
from periph_sim.imu.host_frames import ramp
from periph_sim.imu.models.parameters import ImuParameters, MagnetometerParameters
from periph_sim.scene.case.model import BadCase
from tests.imu.models.recording import codes_of
from tests.scene.runs import Ran, run_file

FLOAT = "unit.dsp.settings.arithmetic=float64"


def expected(frames: int) -> list[list[str]]:
    """Return the bytes that the sensor head reads after 0, 1, 2 ... frames, computed from recordings of the frames."""
    rows = []
    for sent in ([(0,) * 6], [ramp(n) for n in range(frames)]):
        counts = np.array(sent, dtype=np.float64).reshape(-1, 6)
        codes = codes_of(ImuParameters(), (counts[:, :3] * 1e-4).tolist(), (counts[:, 3:] * 1e-3).tolist())
        rows += [[int(axis) for chip in one for axis in chip] for one in codes]
    return [
        [pack(">3h", *row[0:3]).hex(" "), pack("<3h", *row[3:6]).hex(" "), pack(">3h", row[6], row[8], row[7]).hex(" ")]
        for row in rows
    ]


def test_the_sensor_head_reads_the_codes_that_the_models_compute_from_the_frames():
    ran = run_file("imu_models", "0.2", FLOAT)
    read = ran.read()
    # The models run at the end of a round: at 5 and 25 ms the head reads frames that had arrived by 0 and 5 ms.
    assert read[0] == expected(0)[0]
    assert len(read) == 10 and read[1:] == expected(9)[1:10]


def test_without_new_frames_the_rates_are_0():
    ran = run_file("imu_models", "0.2", FLOAT, "host.frames=3")
    late = [unpack(">3h", bytes.fromhex(gyroscope)) for gyroscope, _, _ in ran.read()[5:]]
    assert set(late) == {(-43, 51, 2)}  # the biases, and a tenth of 1.026 g, through S
    assert len({accelerometer for _, accelerometer, _ in ran.read()[5:]}) == 1


def test_the_cost_of_the_model_is_the_estimate_of_its_operations():
    ran = run_file("imu_models", "0.1")
    execution = {verdict.name: verdict for verdict in ran.result.budgets}["model execution"]
    assert execution.worst == pytest.approx(1798 / 150, abs=0.01)  # us: half way between 1789 and 1807 cycles
    assert ran.broken() == []


def test_q16_is_within_its_bound_of_float64_on_the_bus():
    exact, coarse = (
        run_file("imu_models", "0.2", f"unit.dsp.settings.arithmetic={name}") for name in ("float64", "q16")
    )
    pairs = zip(exact.read(), coarse.read(), strict=True)
    codes = [[unpack(">3h", bytes.fromhex(text)) for text in (one[0], one[2])] for both in pairs for one in both]
    off = np.abs(np.array(codes[0::2]) - np.array(codes[1::2])).max(axis=(0, 2))
    assert off[0] <= 1 and off[1] <= 3


def test_a_yaw_wrap_is_a_wrong_sign_in_q16_and_full_scale_in_float32():
    frames = [pack("<6h", 0, 0, yaw, 0, 0, 1000) for yaw in (31241, -31241)]  # 179 and -179 degrees
    assert degrees(31241e-4) == pytest.approx(179, abs=0.01)
    z = {}
    for name in ("float64", "float32", "q16", "q16 saturating"):
        models = Models(name, ImuParameters())
        results = [models.chips(frame)[0] for frame in (frames[0], frames[0], frames[1])]
        z[name] = unpack(">3h", results[-1])[2]
    assert z["float64"] == z["float32"] == -32768 == z["q16 saturating"]
    exact = 14.375 * (0.04 + 0.02 * 0.5 - degrees(62482e-4) / 0.02)
    assert z["q16"] == pytest.approx((exact + 32768) % 65536 - 32768, abs=4)  # the value modulo 2**16


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("arithmetic=q20", "gyroscope: -32768 does not fit Q20"),
        ("arithmetic=q17x", "there is no arithmetic 'q17x'"),
        ("parameters=nowhere.toml", "nowhere.toml: cannot be read"),
        ("model_cost=guess", "'guess' is no length of time"),
        ("model_cost=12", "12 has no unit"),
    ],
)
def test_invalid_settings_are_refused_with_their_place(setting: str, message: str):
    with pytest.raises(BadCase, match=r"unit\.dsp\.settings\.") as refused:
        run_file("imu_models", "0.01", f"unit.dsp.settings.{setting}")
    assert message in str(refused.value)


def test_parameters_come_from_a_file(tmp_path):
    file = tmp_path / "quiet.toml"
    file.write_text('[gyroscope]\nbias = "0, 0, 0 deg/s"\n', encoding="utf-8")
    ran = run_file("imu_models", "0.01", f"unit.dsp.settings.parameters={file}")
    assert ran.read()[0][0] == "00 00 00 00 00 00"


def test_an_estimate_without_an_arithmetic_is_refused():
    with pytest.raises(BadCase, match=r", line \d+.*: unit\.dsp\.settings: model_cost = .* needs an arithmetic"):
        run_file("imu_hil_published", "0.01", "unit.dsp.settings.model_cost=estimate")


def test_a_field_along_z_gives_no_warning(recwarn):
    field = ImuParameters(magnetometer=MagnetometerParameters(earth_field=(0.0, 0.0, 0.3), hard_iron=(0.0, 0.0, 0.0)))
    codes = {name: Models(name, field).chips(bytes(12))[2] for name in ("float64", "float32", "q16")}
    assert unpack(">3h", codes["float64"]) == unpack(">3h", codes["q16"]) == (0, 198, 0)  # x, z, y: 0.3 gauss down
    assert unpack(">3h", codes["float32"]) != (0, 198, 0)  # 0/0 in fastRTS's atan2
    assert not recwarn.list


CHECKED = (
    'controller.check="host"',
    "unit.dsp.settings.noise_seed=11",
    'budget=[{name="wrong bytes", measure="wrong bytes", max=0}]',
)


@pytest.mark.parametrize("arithmetic", ["q16", "float64"])
def test_noisy_bytes_are_compared_with_the_models_frame_by_frame(arithmetic: str):
    ran = run_file("imu_models", "0.3", f"unit.dsp.settings.arithmetic={arithmetic}", *CHECKED)
    (verdict,) = ran.result.budgets
    assert (verdict.verdict, verdict.worst, verdict.count) == ("pass", 0, 15 * 18)


def test_bytes_of_shifted_frames_are_wrong():
    ran = run_file("imu_models", "0.3", *CHECKED, "unit.dsp.settings.fifo_level=11")  # frames slip by a byte
    assert ran.broken() == ["wrong bytes"]


def test_a_check_of_the_models_needs_the_pin_that_shows_when_they_run():
    with pytest.raises(BadCase, match=r"controller\.check: .* give the unit pins = \{ MODEL = 34 \}"):
        run_file("imu_models", "0.01", *CHECKED, "unit.dsp.pins={}")


FAST = "host.motion.angles.2.frequency=7 Hz"  # 60 degrees of yaw: up to 2639 deg/s, which a chip of 2000 deg/s clips


def overflows(ran: Ran) -> tuple[int, str, str]:
    """Return the number of overflows, the verdict, and the note of a run of imu_hil."""
    found = {verdict.name: verdict for verdict in ran.result.budgets}["overflows"]
    notes = [note for note in ran.result.notes if "does not fit" in note]
    return found.count, found.verdict, " ".join(notes)


def test_overflows_are_counted_and_the_first_has_its_time_and_line():
    count, verdict, note = overflows(run_file("imu_hil", "0.1", FAST))
    assert count and verdict == "fail"
    assert note.startswith("dsp: a result of the sensor models does not fit q16 [IQmath guide V1.70] (")
    assert f"({count} time" in note and ", first at " in note and "of imu_models.py)" in note


def test_a_scene_that_is_run_again_reports_the_overflows_of_remembered_samples():
    assert overflows(run_file("imu_hil", "0.1", FAST)) == overflows(run_file("imu_hil", "0.1", FAST))


@pytest.mark.parametrize("arithmetic", ["float64", "float32"])
def test_floats_have_no_overflows(arithmetic: str):
    assert overflows(run_file("imu_hil", "0.1", FAST, f"unit.dsp.settings.arithmetic={arithmetic}"))[0] == 0


@pytest.mark.parametrize("name", ["float64", "q16"])
def test_the_rates_of_the_first_frame_are_0(name: str):
    """The zeros before any frame mean rest, while a received frame of zeros is an attitude like any other."""
    models, quarter = Models(name, ImuParameters()), pack("<6h", 0, 0, 15708, 0, 0, 1000)
    models.chips(NO_FRAME)
    first, second = models.chips(quarter)[0], models.chips(quarter)[0]
    assert first == second
    turned = Models(name, ImuParameters())
    turned.chips(bytes(12))
    assert turned.chips(quarter)[0] != first


def test_a_unit_that_reports_no_overflows_has_no_such_budget():
    with pytest.raises(BadCase, match="overflows are counted by Python firmware that reports them, and dsp does"):
        run_file("imu_hil_image", "0.001", 'budget=[{name="o", measure="overflows", max=0}]')
