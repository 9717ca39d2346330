"""A run recorded as .psr: the same records as in .jsonl, one by one; every other recording can be made from it."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.records.recording import BadRecording, recording, rewrite
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from periph_sim.traces import formats
from periph_sim.traces.capture.sampling import resampled
from periph_sim.traces.formats import psr

WORDS = {"address": r"0x[0-9A-F]{2} [RW] N?ACK", "byte": r"0x[0-9A-F]{2}( N?ACK)?", "end": r"0x[0-9A-F]{2}"}
TIMING = Path(__file__).resolve().parents[3] / "timing"


def record(case_name: str, path: Path) -> Path:
    case = load(TIMING / f"{case_name}.toml", ["duration=60 ms"])
    with recording(path, case.recorded_modules) as (subscribe, ended_at):
        scene = Scene(case, subscribe)
        scene.run()
        ended_at(scene.kernel.now, scene.clocks())
    return path


@pytest.fixture(params=["imu_hil_published", "two_dsps"], scope="module")
def recorded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Path]]:
    yield request.param, record(request.param, tmp_path_factory.mktemp("runs") / "run.psr")


def test_the_records_are_those_of_the_jsonl_one_by_one(recorded: tuple[str, Path], tmp_path: Path):
    case, path = recorded
    lines = record(case, tmp_path / "run.jsonl").read_text(encoding="utf-8").splitlines()
    table = psr.read_table(path)
    rows = [[r.number, r.tick, r.kind.value, *r[3:]] for r in table.records()]
    written = [json.loads(line) for line in lines[1:]]
    for row, line in zip(rows, written, strict=True):
        if row[2] in ("bus", "frame"):  # their values are words in a .jsonl
            assert line[5] is None or re.fullmatch(WORDS[row[4]], line[5])
            row[5] = line[5]
    assert len(rows) > 1000 and rows == written
    assert table.per_second == json.loads(lines[0])["ticks_per_second"]


@pytest.mark.parametrize("suffix", [".jsonl", ".vcd", ".sr", ".perfetto.json", ".psr"])
def test_rewritten_it_is_the_recording_in_that_format_byte_for_byte(
    recorded: tuple[str, Path], tmp_path: Path, suffix: str
):
    case, path = recorded
    rewrite(psr.read_table(path), tmp_path / f"again{suffix}")
    live = record(case, tmp_path / f"live{suffix}")
    assert (tmp_path / f"again{suffix}").read_bytes() == live.read_bytes()


@pytest.mark.parametrize("suffix, rate", [(".vcd", 10**9), (".sr", 10**8)])
def test_its_wires_are_those_of_other_recordings_at_their_rate(
    recorded: tuple[str, Path], tmp_path: Path, suffix: str, rate: int
):
    case, path = recorded
    other = formats.read(record(case, tmp_path / f"run{suffix}"))
    wires = formats.read(path)
    assert len(wires.channels) > 1 and other.rate == rate
    for wire in resampled(wires, Fraction(rate)).channels:
        found = other.channel(wire.name)
        assert (found.initial, found.edges.tolist()) == (wire.initial, wire.edges.tolist())


def test_a_capture_is_not_rewritten_as_a_run(tmp_path: Path):
    table = psr.read_table(_capture(tmp_path / "x.psr"))
    with pytest.raises(BadRecording) as caught:
        rewrite(table, tmp_path / "x.jsonl")
    assert str(caught.value) == (
        f"{tmp_path}/x.jsonl: cannot be written (4000000 ticks a second; a run has whole ones a nanosecond)"
    )
    assert [path.name for path in tmp_path.iterdir()] == ["x.psr"]


def _capture(path: Path) -> Path:
    formats.write(formats.read(TIMING.parent / "traces" / "nack.sr"), path)
    return path


BEGINS_SLOWLY = """
 .sect ".text", 0x9000
_c_int00: EALLOW
 MOVW DP,#0x7029 >> 6
 MOV @0x7029,#0x68
 MOVW DP,#0x7021 >> 6
 MOV @0x7021,#10
 MOVW DP,#0x7011 >> 6
 AND @0x7011,#0xFE7F
 OR @0x7011,#2 << 7
loop: SB loop,UNC
"""


def test_it_tells_the_clocks_that_the_program_set_up(tmp_path: Path):
    (tmp_path / "own.asm").write_text(BEGINS_SLOWLY)
    unit = 'image = "own.asm"\nmodules = ["GPIO"]\noscclk = "20 MHz"\nppm = 50'
    (tmp_path / "own.toml").write_text(f'name = "own"\nduration = "10 ms"\n[unit.dsp]\n{unit}\n')
    case = load(tmp_path / "own.toml")
    with recording(tmp_path / "own.psr", case.recorded_modules) as (subscribe, ended_at):
        scene = Scene(case, subscribe)
        scene.run()
        ended_at(scene.kernel.now, scene.clocks())
    table = psr.read_table(tmp_path / "own.psr")
    crystal = 20 * (1 + Fraction(50, 10**6))
    megahertz = [hz / 10**6 for _, hz in table.clocks["dsp"]]
    assert megahertz == [crystal / 4, crystal / 2, crystal * 5]  # the reset's, DIVSEL, and once the PLL has locked
    assert table.clocks["dsp"][0][0] == 0
    locks = Fraction(table.clocks["dsp"][2][0], table.per_second)
    assert locks == pytest.approx(131_072 / (crystal * 10**6), rel=1e-3)
