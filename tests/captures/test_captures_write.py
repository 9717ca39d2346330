"""Real captures written as sessions: the same edges come back, and sigrok decodes them to the same events."""

from __future__ import annotations

import shutil
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.traces import formats
from tests.captures.where import FOLDER, captures, needs_captures
from tests.traces.formats.looks import edges, facts
from tests.traces.formats.sigrok import sigrok_says

QUICK = 20_000_000  # samples: more would take seconds each
GRID = {"uart_async115200_csv.csv": 500_000_000, "i2c_mdfu_write_csv.csv": 125_000_000}


@pytest.mark.parametrize("path", captures(), ids=lambda path: path.name)
def test_written_and_read_again_the_edges_are_the_same(path: Path, tmp_path: Path):
    capture = formats.read(path, Fraction(GRID[path.name]) if path.name in GRID else None)
    if not capture.sampled or capture.length > QUICK:
        pytest.skip("not sampled, or long")
    formats.write(capture, tmp_path / "again.sr")
    again = formats.read(tmp_path / "again.sr")
    assert [*edges(again).values()] == [*edges(capture).values()]
    assert facts(again) == facts(capture)


@needs_captures
@pytest.mark.skipif(shutil.which("sigrok-cli") is None, reason="sigrok-cli is not installed")
@pytest.mark.parametrize(
    ("name", "decoder"),
    [
        ("i2c_ds3231_ex2.sr", "i2c:scl=SCL:sda=SDA"),
        ("i2c_pca9571_warning.sr", "i2c:scl=SCL:sda=SDA"),
        ("uart_gps_9600.sr", "uart:tx=TX:baudrate=9600"),
        ("uart_count_8n1.sr", "uart:tx=tx:baudrate=19200"),
    ],
)
def test_sigrok_decodes_it_to_the_same_events(name: str, decoder: str, tmp_path: Path):
    formats.write(formats.read(FOLDER / name), tmp_path / name)
    said = [sigrok_says(path, decoder) for path in (FOLDER / name, tmp_path / name)]
    assert said[0] == said[1] and len(said[0].splitlines()) > 10
