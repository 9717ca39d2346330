"""Public images run unmodified: bytes on the wires as written, first edges as an earlier study has them, +/- 2 %.

Skipped where `PERIPH_SIM_IMAGES` names no folder of them. The rows are those of tests/image/public_images.toml.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from tests.commands.conftest import Run, periph_sim  # noqa: F401
from tests.image.public_images import public_image

CONSOLE, CONSOLE_C, CONSOLE_B, EEPROM, CLOCK, LEDS, ECHO, SENDER = "S1", "S2", "S3", "S4", "S5", "S6", "S7", "S8"
BANNER = (
    b"\r\n\n\nHello Yan Xu!\r\nYou will enter a character, and the DSP will echo it back! \n\r\nEnter a character: "
)
TOLERANCE = 0.02
CASE = """\
name = "public"
duration = "{duration}"

[unit.dsp]
image = "{image}"
modules = ["{module}", "GPIO", "TIMER0", "TIMER1", "TIMER2"]
"""


def recorded(
    periph_sim: Run,  # noqa: F811
    folder: Path,
    image: str,
    duration: str,
    module: str,
    more: str,
    *,
    status: int = 0,
) -> Path:
    """The recording of a run of a public image."""
    case = CASE.format(duration=duration, image=public_image(image), module=module)
    (folder / "case.toml").write_text(case + more)
    came = periph_sim("run", str(folder / "case.toml"), "--record", str(folder / "run.sr"))
    assert came.status == status, came.out + came.err
    return folder / "run.sr"


def sent(periph_sim: Run, run: Path, wire: str, baud: int) -> list[tuple[float, bytes]]:  # noqa: F811
    """Bursts of bytes on a serial line, with the time of each one's first start bit."""
    shown = periph_sim("decode", str(run), "--transfers", "--uart", f"tx={wire},baud={baud}").out
    rows = [line.split() for line in shown.splitlines() if line.strip()[:1].isdigit()]
    return [(float(time), bytes.fromhex("".join(word for word in words if word[0] != "["))) for time, *words in rows]


def first_rise(vcd: Path, wire: str) -> float:
    """When a wire first rises behind its first fall, in seconds; the recording counts nanoseconds."""
    lines, now, low = vcd.read_text().split("\n"), 0, False
    assert "$timescale 1 ns $end" in lines
    code = next(line.split()[3] for line in lines if line.startswith("$var") and line.split()[4] == wire)
    for line in lines:
        if line.startswith("#"):
            now = int(line[1:])
        low = low or line == f"0{code}"
        if low and line == f"1{code}":
            return now / 1e9
    raise AssertionError(f"{wire} does not rise")


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


def test_a_console_on_sci_c_sends_its_banner_and_waits_for_a_key(periph_sim: Run, tmp_path: Path):  # noqa: F811
    """Nobody sends one, and the run says so."""
    case = '[serial]\nbaud = 9600\n[[budget]]\nname = "line"\nmeasure = "overruns"\nmax = 0\n'
    run = recorded(periph_sim, tmp_path, CONSOLE_C, "110 ms", "SCI-C", case, status=1)
    [(began, told)] = sent(periph_sim, run, "SCI-C.TX", 9600)
    assert (told, began) == (BANNER, pytest.approx(4.437e-3, rel=TOLERANCE))
    assert "waits for SCI-C.SCIRXST.RXRDY since 106." in periph_sim("run", str(tmp_path / "case.toml")).out


def test_a_console_behind_rs_485_sends_on_gpio22_with_its_driver_on(periph_sim: Run, tmp_path: Path):  # noqa: F811
    pins = "pins = { OUT = 22, DE = 49 }\n"
    run = recorded(periph_sim, tmp_path, CONSOLE_B, "12 ms", "SCI-B", pins, status=1)
    [(began, told)] = sent(periph_sim, run, "OUT", 9600)
    assert (told, began) == (BANNER[: len(told)], pytest.approx(4.437e-3, rel=TOLERANCE))


def test_a_clock_is_set_byte_by_byte_from_interrupts(periph_sim: Run, tmp_path: Path):  # noqa: F811
    more = '[device.clock]\nmodel = "isl12026"\n[[budget]]\nname = "clean"\nmeasure = "nacked"\nmax = 0\n'
    run = recorded(periph_sim, tmp_path, CLOCK, "16 ms", "I2C-A", more)
    rows = [line.split() for line in periph_sim("decode", str(run), "--transfers").out.splitlines() if " S " in line]
    written = ("3F 02", "3F 06", "37 20", "35 07", "34 12", "33 03", "36 01", "32 15", "31 39", "30 50")
    bytes_of = [" ".join(word for word in row[1:] if word != "A") for row in rows]
    assert bytes_of == [*(f"S 6F W 00 {pair} P" for pair in written), "S 6F W 00 30"]
    starts = [float(row[0]) for row in rows]
    assert starts[0] == pytest.approx(4.4984e-3, rel=TOLERANCE)
    assert {round(after - before, 6) for before, after in pairwise(starts)} <= {0.001095, 0.001096}


def test_leds_come_on_one_after_the_other_and_toggle_each_half_second(periph_sim: Run, tmp_path: Path):  # noqa: F811
    pins = "pins = { L0 = 0, L1 = 1, L2 = 2, L3 = 3, L4 = 4 }\n"
    case = CASE.format(duration="1100 ms", image=public_image(LEDS), module="SCI-A") + pins
    (tmp_path / "case.toml").write_text(case)
    periph_sim("run", str(tmp_path / "case.toml"), "--record", str(tmp_path / "run.vcd"))
    at = [first_rise(tmp_path / "run.vcd", f"L{n}") for n in range(5)]
    assert [after - before for before, after in pairwise(at)] == [pytest.approx(10.04e-6, abs=0.2e-6)] * 4


def test_an_echo_with_the_fpu_sends_its_banner_on_gpio35(periph_sim: Run, tmp_path: Path):  # noqa: F811
    run = recorded(periph_sim, tmp_path, ECHO, "165 ms", "SCI-A", "pins = { OUT = 35 }\n", status=1)
    [(began, told)] = sent(periph_sim, run, "OUT", 4800)
    assert told == b"Hello World!\r\nYou will enter a character, and the DSP will echo it back!\r\n"
    assert began == pytest.approx(4.505e-3, rel=TOLERANCE)


def test_a_sender_sends_each_10_ms(periph_sim: Run, tmp_path: Path):  # noqa: F811
    run = recorded(periph_sim, tmp_path, SENDER, "26 ms", "SCI-A", "", status=1)
    came = sent(periph_sim, run, "TX", 9600)
    assert [told for _, told in came] == [b"s"] * 3
    assert came[0][0] == pytest.approx(4.457e-3, rel=TOLERANCE)
    assert {9.994e-3 <= after - before <= 10.0075e-3 for (before, _), (after, _) in pairwise(came)} == {True}
