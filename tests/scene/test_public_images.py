"""Public images run unmodified: bytes on the wires as written, the first START within 2 % until stalls are counted.

Skipped where `PERIPH_SIM_IMAGES` names no folder of them. The rows are those of tests/image/public_images.toml.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.commands.conftest import Run, periph_sim  # noqa: F401
from tests.image.public_images import public_image

CONSOLE, EEPROM = "S1", "S4"
TOLERANCE = 0.02
CASE = """\
name = "public"
duration = "{duration}"

[unit.dsp]
image = "{image}"
modules = ["{module}", "GPIO", "TIMER0", "TIMER1", "TIMER2"]
"""


def recorded(periph_sim: Run, folder: Path, image: str, duration: str, module: str, more: str) -> Path:  # noqa: F811
    """The recording of a run of a public image."""
    case = CASE.format(duration=duration, image=public_image(image), module=module)
    (folder / "case.toml").write_text(case + more)
    came = periph_sim("run", str(folder / "case.toml"), "--record", str(folder / "run.sr"))
    assert came.status == 0, came.out + came.err
    return folder / "run.sr"


def test_an_eeprom_is_written_over_its_pages_end_and_read_back(periph_sim: Run, tmp_path: Path):  # noqa: F811
    more = '[device.memory]\nmodel = "24c02"\n[[budget]]\nname = "clean"\nmeasure = "nacked"\nmax = 0\n'
    run = recorded(periph_sim, tmp_path, EEPROM, "17 ms", "I2C-A", more)
    rows = [line.split() for line in periph_sim("decode", str(run), "--transfers").out.splitlines() if " S " in line]
    assert float(rows[0][0]) == pytest.approx(4.4623e-3, rel=TOLERANCE)
    assert [" ".join(word for word in row[1:] if word != "A") for row in rows] == [
        "S 50 W 00 11 22 33 44 55 66 77 88 99 00 P",
        "S 50 W 00 Sr 50 R 99 00 33 44 55 66 77 88 FF FF N P",
    ]


def test_a_console_answers_with_the_character_it_got(periph_sim: Run, tmp_path: Path):  # noqa: F811
    more = (
        '[serial]\nbaud = 9600\n[[serial.send]]\nname = "A"\nto = "dsp.SCI-A"\ntext = "A"\nat = "115 ms"\n'
        '[[serial.expect]]\nname = "answer"\nfrom = "dsp.SCI-A"\ntext = "  You sent: A"\nafter_send = "A"\n'
        'within = "20 ms"\n'
    )
    recorded(periph_sim, tmp_path, CONSOLE, "135 ms", "SCI-A", more)
