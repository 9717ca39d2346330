"""Names in a case of things that do not exist: one sentence with file, line and the nearest existing name."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from periph_sim import BadCase, FirmwareError, Scene, load
from periph_sim.scene.firmware_loader import BadFirmware, load_firmware
from periph_sim.timing.language.language import FORMS
from periph_sim.timing.measures.registry import MEASURES
from tests.scene.small import case, sentence_of

TEXT = """\
name = "small"
duration = "1 ms"

[unit.dsp]
firmware = "imu_hil"
modules = ["I2C-A"]

[unit.dsp.settings]
model_cost = "250 us"

[unit.dsp.options.i2c]
bcm_reset = 1

[controller]
order = ["gyroscope"]

[[budget]]
name = "answer"
measure = "response"
max = "60 us"
"""

NEEDS_ADDRESS = """\
from __future__ import annotations

from dataclasses import dataclass

from periph_sim.firmware import Duration


@dataclass
class Settings:
    address: int
    pause: Duration


def main(dsp, settings):
    pass
"""


def refusal(path: Path, *changes: str) -> str:
    return sentence_of(BadCase, lambda: Scene(load(path, list(changes))))


@pytest.fixture
def case_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = Path("small.toml")
    path.write_text(TEXT, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("line", "by", "sentence"),
    [
        (
            'modules = ["I2C-A"]',
            'modules = ["I2C-B"]',
            "small.toml, line 6: unit.dsp.modules: there is no module 'I2C-B'; did you mean I2C-A or SCI-B?",
        ),
        (
            'firmware = "imu_hil"',
            'firmware = "imu_hill"',
            "small.toml, line 5: unit.dsp.firmware: there is no firmware 'imu_hill'; did you mean imu_hil or "
            "imu_hil_robust?",
        ),
        (
            'firmware = "imu_hil"',
            'firmware = "missing.py"',
            "small.toml, line 5: unit.dsp.firmware: there is no firmware file 'missing.py'; "
            "its path counts from the folder of the case",
        ),
        (
            'firmware = "imu_hil"',
            'firmware = "empty.py"',
            "small.toml, line 5: unit.dsp.firmware: firmware 'empty.py' has no function main(dsp, settings)",
        ),
        (
            'firmware = "imu_hil"',
            'firmware = "broken.py"',
            "small.toml, line 5: unit.dsp.firmware: firmware 'broken.py' cannot be loaded: "
            "line 1 of broken.py: ZeroDivisionError: division by zero",
        ),
        (
            'model_cost = "250 us"',
            'model_costs = "250 us"',
            "small.toml, line 9: unit.dsp.settings.model_costs: "
            "firmware imu_hil has no setting 'model_costs'; did you mean model_cost or frame_cost?",
        ),
        (
            'model_cost = "250 us"',
            'model_cost = "240 uus to 260 us"',
            "small.toml, line 9: unit.dsp.settings.model_cost: '240 uus': unit 'uus' is none of "
            "ns, us, ms, s, min, h, d; did you mean 240 us?",
        ),
        (
            'model_cost = "250 us"',
            "model_cost = 250",
            'small.toml, line 9: unit.dsp.settings.model_cost: 250 has no unit; write for instance "250 ms"',
        ),
        (
            'model_cost = "250 us"',
            'order = ["x"]',
            "small.toml, line 9: unit.dsp.settings.order: expected a whole number, but it is 'x'",
        ),
        (
            "bcm_reset = 1",
            "bcm_rest = 1",
            "small.toml, line 12: unit.dsp.options.i2c.bcm_rest: there is no option 'bcm_rest'; "
            "did you mean bcm_reset or emdr_present?",
        ),
        (
            "bcm_reset = 1",
            "bcm_reset = 2",
            "small.toml, line 12: unit.dsp.options.i2c.bcm_reset: option bcm_reset is 2; expected 1 or 0",
        ),
        (
            "bcm_reset = 1",
            "bcm_reset = true",
            "small.toml, line 12: unit.dsp.options.i2c.bcm_reset: option bcm_reset is True; expected 1 or 0",
        ),
        (
            "[unit.dsp.options.i2c]",
            "[unit.dsp.options.i2]",
            "small.toml, line 11: unit.dsp.options.i2: there are no options of 'i2'; did you mean i2c?",
        ),
        (
            'order = ["gyroscope"]',
            'order = ["gyroscop"]',
            "small.toml, line 15: controller.order: there is no chip 'gyroscop'; did you mean gyroscope?",
        ),
        (
            'order = ["gyroscope"]',
            '[[controller.request]]\nchip = "magnet"',
            "small.toml, line 16: controller.request.0.chip: there is no chip 'magnet'; did you mean magnetometer?",
        ),
        (
            'order = ["gyroscope"]',
            "order = []",
            "small.toml, line 14: controller: it has no requests; give it order or [[controller.request]]",
        ),
        (
            'measure = "response"',
            'measure = "latency"',
            "small.toml, line 19: budget.answer.measure: there is no measure 'latency'; it has "
            f"{', '.join(MEASURES)}, overflows, unsolicited replies, span:NAME, reply:NAME, silence:NAME, watch:NAME, "
            f"and {', '.join(FORMS.values())}",
        ),
        (
            'max = "60 us"',
            "max = 60",
            'small.toml, line 20: budget.answer.max: 60 has no unit; write for instance "60 ms"',
        ),
        (
            'max = "60 us"',
            "max = [250]",
            'small.toml, line 20: budget.answer.max: expected a duration with its unit ("250 us"), or a whole number '
            "for counts, but it is [250]",
        ),
        (
            'max = "60 us"',
            'max = "60 us"\nmin = "61 us"',
            "small.toml, line 21: budget.answer.min: min 61 us is above max 60 us, so no run can keep both; "
            "raise max or lower min",
        ),
    ],
)
def test_a_mistake_is_reported_with_file_line_and_correction(case_file: Path, line: str, by: str, sentence: str):
    assert line in TEXT
    Path("empty.py").write_text("", encoding="utf-8")
    Path("broken.py").write_text("1 / 0\n", encoding="utf-8")
    case_file.write_text(TEXT.replace(line, by), encoding="utf-8")
    assert refusal(case_file) == sentence


def test_a_wrong_name_in_a_change_is_quoted_as_typed(case_file: Path):
    assert refusal(case_file, "unit.dsp.firmware=imu_hill") == (
        "small.toml, --set 'unit.dsp.firmware=imu_hill': unit.dsp.firmware: "
        "there is no firmware 'imu_hill'; did you mean imu_hil or imu_hil_robust?"
    )


def test_a_case_without_a_file_is_identified_by_its_name():
    with pytest.raises(BadCase, match=r"^case small: controller.order: there is no chip 'x'; it has gyroscope, "):
        Scene(case(controller={"order": ["x"]}))


def test_a_setting_that_firmware_needs_is_missing(case_file: Path):
    Path("needs.py").write_text(NEEDS_ADDRESS, encoding="utf-8")
    message = refusal(case_file, "unit.dsp.firmware=needs.py", "unit.dsp.settings={}")
    assert message == ("small.toml, --set 'unit.dsp.settings={}': unit.dsp.settings.address: it is missing")


def test_firmware_without_settings_takes_none(case_file: Path):
    Path("plain.py").write_text("def main(dsp, settings):\n    pass\n", encoding="utf-8")
    message = refusal(case_file, "unit.dsp.firmware=plain.py")
    assert message == ("small.toml, line 9: unit.dsp.settings.model_cost: firmware plain.py takes no settings")


def test_firmware_is_a_name_of_the_folder_not_a_module_path():
    with pytest.raises(BadFirmware, match="there is no firmware 'os'"):
        load_firmware("os")


@pytest.mark.parametrize("name", ["x" * 300, f"{'x' * 300}.py"])
def test_a_file_name_that_the_system_refuses_is_reported_in_one_sentence(case_file: Path, name: str):
    message = f"unit.dsp.firmware: firmware {name!r} cannot be loaded: OSError: [Errno 36] File name too long"
    if sys.version_info >= (3, 14) and not name.endswith(".py"):  # Path.is_file() is False for such a name
        message = "there is no firmware 'xxxxx"
    assert message in refusal(case_file, f"unit.dsp.firmware={name}")
    if name.endswith(".py"):
        message = refusal(case_file, f"device.own={{model = '{name}', address = 80}}")
        assert f"device.own.model: {name} cannot be loaded: OSError: [Errno 36] File name too long" in message


SENSORS = """\
from dataclasses import dataclass


@dataclass
class Settings:
    @property
    def sensors(self):
        return 1 // 0


def main(dsp, settings):
    pass
"""


def test_an_error_in_a_property_of_the_settings_is_one_of_the_firmware(case_file: Path):
    Path("own.py").write_text(SENSORS, encoding="utf-8")
    with pytest.raises(FirmwareError, match=r"firmware own\.py: ZeroDivisionError at line 8 of own\.py"):
        Scene(load(case_file, ["unit.dsp.firmware=own.py", "unit.dsp.settings={}"]))


def test_a_unit_with_too_many_wires_is_refused():
    pins = {f"P{pin}": pin for pin in range(60)}
    made = case(unit={"dsp": {"firmware": "imu_hil", "modules": ["GPIO", "SCI-C"], "pins": pins}})
    assert Scene(made).units["dsp"].plan.wires.keys() == {*range(60), 62, 63}
    more = case(unit={"dsp": {"firmware": "imu_hil", "modules": ["GPIO", "SCI-C"], "pins": {**pins, "P60": 60}}})
    with pytest.raises(BadCase, match=r"unit\.dsp\.pins: the pins of the unit would have 63 wires; at most 62"):
        Scene(more)
