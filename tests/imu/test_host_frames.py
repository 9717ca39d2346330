"""A motion in a case: the host's frames on the wire and through the firmware, and refused motions with their line."""

from __future__ import annotations

from math import pi, sin
from pathlib import Path

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.imu.host_frames import encode
from periph_sim.imu.motion import BadMotion
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from periph_sim.scene.scene import Scene
from tests.scene.runs import run_file
from tests.scene.small import case

SINE = 'host.motion={kind = "sines", angles = [{of = "theta", amplitude = "50 deg", frequency = "3 Hz"}]}'


def counts(number: int) -> int:
    return round(1e4 * 50 * pi / 180 * sin(2 * pi * 3 * (0.002 + number * 0.02)))


def test_the_emulator_shows_the_motion_of_the_host():
    ran = run_file("imu_hil_published", "0.3", SINE)
    assert ran.broken() == []
    assert ran.result.counts["beyond_16_bits"] == 0
    shown = [bytes.fromhex(gyroscope) for gyroscope, _, _ in ran.read()]
    pitches = [int.from_bytes(data[2:4], "big", signed=True) for data in shown]
    assert pitches[2:] == [counts(number) for number in range(1, len(pitches) - 1)]


def test_without_a_motion_values_out_of_range_are_not_counted():
    assert "beyond_16_bits" not in run_file("imu_hil_published", "0.05").result.counts


def sent(**host: object) -> bytes:
    scene = Scene(case("25 ms", host=host))
    frames: list[tuple[int, ...]] = []
    assert scene.host is not None
    scene.host.sent.append(lambda number, values, tick: frames.append(values))
    scene.run()
    return encode(frames[0])


def test_frames_have_the_scales_of_the_encoding():
    motion = {"kind": "static", "theta": "1 deg", "az": "-1 g"}
    assert sent(motion=motion, encoding={"theta": "1/100 deg", "az": "1/256 g"}) == encode((0, 100, 0, 0, 0, -256))


def test_the_encoding_may_send_the_high_byte_first():
    came: list[Record] = []
    host = {"motion": {"kind": "static", "phi": "0.1 rad"}, "encoding": {"byte_order": "big"}}
    Scene(case("5 ms", host=host), lambda recorder, _: recorder.subscribe([Kind.FRAME], came.append)).run()
    characters = [record.value & 0xFF for record in came if (record.where, record.what) == ("RX", "end")]
    assert characters[:2] == [*(1000).to_bytes(2, "big")]


def test_a_value_beyond_16_bits_ends_the_run_or_is_saturated_or_wrapped_and_counted():
    motion = {"kind": "static", "psi": "200 deg"}
    with pytest.raises(BadMotion, match=r"^frame 0, due at 0.002 s: psi is 3.49066, which is 34907 counts of 0.0001; "):
        sent(motion=motion)
    for beyond, psi in (("saturate", 32767), ("wrap", 34907 - 65536)):
        scene = Scene(case("50 ms", host={"motion": motion, "encoding": {"beyond": beyond}}))
        assert scene.run().counts["beyond_16_bits"] == 3
        assert scene.host_agent is not None and scene.host_agent.values(0)[2] == psi


TEXT = """\
name = "small"
duration = "1 ms"

[unit]

[host]
baud = 115200

[host.motion]
kind = "servo"
fast = "52.2 rpm"

[host.encoding]
phi = "1 deg"
"""


@pytest.mark.parametrize(
    ("line", "by", "sentence"),
    [
        (
            'kind = "servo"',
            'kind = "srvo"',
            "small.toml, line 10: host.motion.kind: there is no motion 'srvo'; did you ",
        ),
        (
            'kind = "servo"',
            "",
            "small.toml, line 9: host.motion.kind: it has no kind; the kinds are flight, servo, sines, static, steps",
        ),
        (
            'fast = "52.2 rpm"',
            'fast = "52.2 deg"',
            "small.toml, line 11: host.motion.fast: '52.2 deg': expected a number, a blank and rad/s or deg/s or rpm",
        ),
        (
            'fast = "52.2 rpm"',
            'fats = "52.2 rpm"',
            "small.toml, line 11: host.motion.fats: motion servo has no setting 'fats'; did you mean fast?",
        ),
        (
            'kind = "servo"\nfast = "52.2 rpm"',
            'kind = "flight"\nfile = "none.csv"',
            "small.toml, line 9: host.motion: none.csv, the file: found no such file or directory, expected a file",
        ),
        (
            'phi = "1 deg"',
            'phi = "0 deg"',
            "small.toml, line 13: host.encoding: phi: one count is 0; expected more than 0",
        ),
        (
            'phi = "1 deg"',
            'beyond = "clip"',
            "small.toml, line 14: host.encoding.beyond: expected 'refuse', 'saturate' or 'wrap', but it",
        ),
    ],
)
def test_an_impossible_motion_is_refused_with_its_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, line: str, by: str, sentence: str
):
    monkeypatch.chdir(tmp_path)
    assert line in TEXT
    Path("small.toml").write_text(TEXT.replace(line, by), encoding="utf-8")
    with pytest.raises(BadCase) as caught:
        Scene(load(Path("small.toml")))
    assert str(caught.value).startswith(sentence)
