"""The VCD files that we write, read by two libraries and by sigrok-cli: the same changes, the same bytes."""

from __future__ import annotations

import re
import shutil
import subprocess
from fractions import Fraction
from pathlib import Path

import pytest
import pywellen
from hypothesis import given, settings

from periph_sim.traces import formats
from periph_sim.traces.capture.capture import changes
from periph_sim.traces.decode import i2c, uart
from periph_sim.traces.formats import Capture
from tests.profiles import examples
from tests.records.vcdvcd_reader import VCDVCD
from tests.traces.formats.strategies import captures

TRACES = Path(__file__).resolve().parents[3] / "traces"
SIGROK = shutil.which("sigrok-cli")
needs_sigrok = pytest.mark.skipif(SIGROK is None, reason="sigrok-cli is not installed")

States = dict[str, list[tuple[int, str]]]


def expected(capture: Capture) -> States:
    """Name as VCD has it -> (position, state)."""
    found: States = {f"capture.{c.name.replace(' ', '_')}": [] for c in capture.channels}
    names = list(found)
    for at, which, state in zip(*(column.tolist() for column in changes(capture)), strict=True):
        found[names[which]].append((at, "01x"[state]))
    return found


def positions(states: States, per_second: Fraction, rate: Fraction) -> States:
    return {name: [(round(at * rate / per_second), state) for at, state in of] for name, of in states.items()}


@given(given=captures())
@settings(max_examples=examples(40), deadline=None)
def test_vcdvcd_reads_the_same_changes(tmp_path_factory: pytest.TempPathFactory, given: Capture):
    path = tmp_path_factory.mktemp("vcd") / "x.vcd"
    formats.write(given, path)
    other = VCDVCD(str(path))
    per_second = 1 / Fraction(str(other.timescale["timescale"]))
    found = {name: [(at, state) for at, state in other[name].tv] for name in other.signals}
    assert positions(found, per_second, given.rate) == expected(given)
    assert round(other.endtime * given.rate / per_second) == given.length


@given(given=captures())
@settings(max_examples=examples(40), deadline=None)
def test_wellen_reads_the_same_changes(tmp_path_factory: pytest.TempPathFactory, given: Capture):
    path = tmp_path_factory.mktemp("vcd") / "x.vcd"
    formats.write(given, path)
    other = pywellen.Waveform(str(path), multi_threaded=False)
    per_second = Fraction(10 ** -other.timescale.unit.to_exponent(), other.timescale.factor)
    found = {re.sub(r"\[3\]$", "", v.full_name): [(at, str(state)) for at, state in v.signal] for v in other.all_vars()}
    plain = {re.sub(r"\[3\]$", "", name): of for name, of in expected(given).items()}  # it takes indices for ranges
    assert positions(found, per_second, given.rate) == plain


def oracle(path: Path, *decoder: str) -> list[str]:
    command = [str(SIGROK), "-I", "vcd", "-i", str(path), "-P", decoder[0], "-A", decoder[1]]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return [line.partition(": ")[2] for line in said.splitlines()]


@needs_sigrok
@pytest.mark.parametrize("name", ["imu_round.sr", "nack.sr"])
def test_sigrok_decodes_the_same_bytes(tmp_path: Path, name: str):
    capture = formats.read(TRACES / name)
    formats.write(capture, tmp_path / "x.vcd")
    wanted = "i2c=address-read:address-write:data-read:data-write:ack:nack"
    said = oracle(tmp_path / "x.vcd", "i2c:scl=SCL:sda=SDA", wanted)
    ours = []
    for event in i2c.events(capture):
        if isinstance(event, i2c.Address):
            ours.append(f"Address {'read' if event.read else 'write'}: {event.value:02X}")
        elif isinstance(event, i2c.Data):
            ours.append(f"Data {'read' if event.read else 'write'}: {event.value:02X}")
        elif isinstance(event, i2c.Ack | i2c.Nack):
            ours.append(type(event).__name__.upper())
    assert len(ours) > 10 and [line for line in said if line in set(ours)] == ours


@needs_sigrok
def test_sigrok_decodes_the_same_frames(tmp_path: Path):
    capture = formats.read(TRACES / "host_frames.sr")
    formats.write(capture, tmp_path / "x.vcd")
    said = oracle(tmp_path / "x.vcd", "uart:rx=RX:baudrate=115200", "uart=rx-data")
    frames = [event for event in uart.events(capture, "RX", uart.Line(115200)) if isinstance(event, uart.Frame)]
    assert said == [f"{frame.value:02X}" for frame in frames] and len(said) == 24
