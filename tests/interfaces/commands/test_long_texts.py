"""Options and files that hold far too long a text: one short sentence and exit status 2, no traceback.

Python refuses to read a number of more than 4300 digits; a message quotes what was given and does not repeat it.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import Run
from tests.traces.formats.writers import metadata, zip_bytes

ROOT = Path(__file__).resolve().parents[3]
NACK, FRAMES = (str(ROOT / "traces" / name) for name in ("nack.sr", "host_frames.sr"))
RESPONDER, LOGGER = (str(ROOT / "timing" / name) for name in ("responder.toml", "uart_logger.toml"))
LONG = "9" * 5000
LONGEST = 3000  # characters of all that is said, click's usage lines included

OPTIONS = [
    ("decode", NACK, "--rate", LONG),
    ("decode", NACK, "--i2c", f"scl={LONG},sda=1"),
    ("decode", NACK, "--glitch", LONG),
    ("decode", NACK, "--glitch", f"{LONG}ns"),
    ("decode", NACK, "--uart", f"rx=0,baud={LONG}"),
    ("decode", NACK, "--uart", LONG),
    ("decode", LONG),
    ("convert", NACK, "a.vcd", "--window", f"0..{LONG}"),
    ("convert", NACK, "a.vcd", "--channels", LONG),
    ("convert", NACK, f"a.{LONG}"),
    ("diff", NACK, NACK, "--tolerance", f"{LONG}us"),
    ("diff", FRAMES, FRAMES, "--uart", f"baud={LONG}"),
    ("replay", NACK, "--case", RESPONDER, "--address", LONG),
    ("replay", NACK, "--case", RESPONDER, "--map", f"scl={LONG}"),
    ("replay", FRAMES, "--case", LOGGER, "--baud", LONG),
    ("compliance", NACK, "--mode", "fast", "--map", f"scl={LONG},sda=1"),
    ("compliance", NACK, "--mode", "fast", "--rate", "1e99"),
]


@pytest.mark.parametrize("arguments", OPTIONS, ids=lambda arguments: f"{arguments[0]} {arguments[-2][:12]}")
def test_an_option_of_five_thousand_digits(periph_sim: Run, desk: Path, arguments: tuple[str, ...]):
    came = periph_sim(*arguments)
    assert came.status == 2 and came.out == ""
    assert "Traceback" not in came.err and "Exceeds the limit" not in came.err
    assert 0 < len(came.err) < LONGEST


@pytest.mark.parametrize(
    "names", [["A" * 5000, "B" * 5000], [f"channel {n} {'C' * 200}" for n in range(64)]], ids=["long", "many"]
)
@pytest.mark.parametrize("command", [("decode",), ("compliance", "--mode", "fast"), ("replay", "--case", RESPONDER)])
def test_channels_with_long_names_are_listed_in_short(periph_sim: Run, desk: Path, command, names: list[str]):
    Path("names.sr").write_bytes(
        zip_bytes({"version": b"2", "metadata": metadata(names, "1 MHz", 8), "logic-1-1": bytes(80)})
    )
    came = periph_sim(command[0], "names.sr", *command[1:])
    assert came.status == 2 and names[0][:20] in came.err and len(came.err) < LONGEST
