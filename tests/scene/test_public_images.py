"""Public images run unmodified: bytes on the wires as written, first edges within 1 us of those of an earlier study.

The study modelled no pipeline stalls, and its times of I2C are those of the address acknowledge. Its times are
therefore checked without stalls. Stalls lengthen the start-up by the rules of docs/images.md, checked to the cycle.
The tests are skipped unless `PERIPH_SIM_IMAGES` names a folder of the images, listed in
tests/processor/image_files/public_images.toml.
"""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import pytest

from periph_sim import form, load
from periph_sim.core.records import Kind
from tests.interfaces.commands.conftest import Run, periph_sim  # noqa: F401
from tests.processor.image_files.public_images import public_image
from tests.scene import runs

CONSOLE, CONSOLE_C, CONSOLE_B, EEPROM, CLOCK, LEDS, ECHO, SENDER = "S1", "S2", "S3", "S4", "S5", "S6", "S7", "S8"
LAB, OVERCLOCKED, KEYPAD, MONITOR = "S9f", "S10", "S11", "S14"
PROMPT = b"You will enter a character, and the DSP will echo it back! \n\r\nEnter a character: "
BANNER = b"\r\n\n\nHello Yan Xu!\r\n" + PROMPT
HELLO = b"Hello World!\r\nYou will enter a character, and the DSP will echo it back!\r\n"
US = 1e-6
TOLERANCE = 1.1 * US  # 1 us, and the rounding of the study
SYSCLK = 150_000_000
STT = 1 << 13
SCICLK = 13.1 * US  # an eighth of a bit at 9600 baud, within which a start bit begins
NO_STALLS = "\n[unit.dsp.options.system]\nstalls = false\n"
CLEAN = '[[budget]]\nname = "clean"\nmeasure = "nacked"\nmax = 0\n'
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
    """Return the recording of a run of a public image."""
    case = CASE.format(duration=duration, image=public_image(image), module=module)
    (folder / "case.toml").write_text(case + more)
    came = periph_sim("run", str(folder / "case.toml"), "--record", str(folder / "run.sr"))
    assert came.status == status, came.out + came.err
    return folder / "run.sr"


def sent(periph_sim: Run, run: Path, wire: str, baud: int) -> list[tuple[float, bytes]]:  # noqa: F811
    """Return the bursts of bytes on a serial line, each with the time of its first start bit."""
    shown = periph_sim("decode", str(run), "--transfers", "--uart", f"tx={wire},baud={baud}").out
    rows = [line.split() for line in shown.splitlines() if line.strip()[:1].isdigit()]
    return [(float(time), bytes.fromhex("".join(word for word in words if word[0] != "["))) for time, *words in rows]


def recorded_as(periph_sim: Run, folder: Path, suffix: str) -> Path:  # noqa: F811
    """Return the recording of the last case in another format."""
    run = folder / f"run{suffix}"
    periph_sim("run", str(folder / "case.toml"), "--record", str(run))
    return run


def first_rise(vcd: Path, wire: str) -> float:
    """Return when a wire first rises after its first fall, in seconds; the recording counts nanoseconds."""
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


def acknowledged(periph_sim: Run, run: Path) -> list[float]:  # noqa: F811
    """Return when targets acknowledge their address, at the ninth rise of SCL."""
    rows = [line.split() for line in periph_sim("decode", str(run)).out.splitlines()]
    return [float(after[0]) for row, after in pairwise(rows) if "address" in row]


def transfers(periph_sim: Run, run: Path) -> list[tuple[float, str]]:  # noqa: F811
    rows = [line.split() for line in periph_sim("decode", str(run), "--transfers").out.splitlines() if " S " in line]
    return [(float(row[0]), " ".join(word for word in row[1:] if word != "A")) for row in rows]


WRITTEN = "S 50 W 00 11 22 33 44 55 66 77 88 99 00 P"


@pytest.mark.parametrize(
    ("page", "read"), [(8, "99 00 33 44 55 66 77 88 FF FF"), (16, "11 22 33 44 55 66 77 88 99 00")]
)
def test_an_eeprom_is_written_across_a_page_and_read_back(periph_sim: Run, tmp_path: Path, page: int, read: str):  # noqa: F811
    device = f'[device.memory]\nmodel = "24c02"\npage = {page}\n'
    run = recorded(periph_sim, tmp_path, EEPROM, "17 ms", "I2C-A", NO_STALLS + device + CLEAN)
    assert [row for _, row in transfers(periph_sim, run)] == [WRITTEN, f"S 50 W 00 Sr 50 R {read} N P"]
    at = acknowledged(periph_sim, run)
    assert at[0] == pytest.approx(4.4623e-3, abs=TOLERANCE)
    assert at[1:] == [pytest.approx(14.704e-3, abs=1.5 * US), pytest.approx(14.757e-3, abs=1.5 * US)]  # given to 1 us
    stalled = acknowledged(periph_sim, recorded(periph_sim, tmp_path, EEPROM, "5 ms", "I2C-A", device + CLEAN))
    assert 4 * US < stalled[0] - at[0] < 5 * US
    text = periph_sim("run", str(tmp_path / "case.toml")).out
    assert "I2CPSC = 9 gives a module clock of 15 MHz at SYSCLKOUT = 150 MHz" in text


def test_a_console_answers_with_the_character_that_it_received(periph_sim: Run, tmp_path: Path):  # noqa: F811
    serial = "[serial]\nbaud = 9600\n"
    for key, at in (("A", 120), ("z", 180)):
        serial += f'[[serial.send]]\nname = "{key}"\nto = "dsp.SCI-A"\ntext = "{key}"\nat = "{at} ms"\n'
        serial += f'[[serial.expect]]\nname = "answer to {key}"\nfrom = "dsp.SCI-A"\nafter_send = "{key}"\n'
        serial += f'text = "  You sent: {key}\\r\\nEnter a character: "\nwithin = "40 ms"\n'
    run = recorded(periph_sim, tmp_path, CONSOLE, "250 ms", "SCI-A", NO_STALLS + serial)
    bursts = sent(periph_sim, run, "TX", 9600)
    assert sum(len(text) for _, text in bursts) == 168
    assert bursts[0] == (pytest.approx(4.437e-3, abs=SCICLK), BANNER)


def test_a_console_on_sci_c_sends_its_banner_and_waits_for_a_key(periph_sim: Run, tmp_path: Path):  # noqa: F811
    """No key is sent, and the run reports the wait for one."""
    case = '[serial]\nbaud = 9600\n[[budget]]\nname = "line"\nmeasure = "overruns"\nmax = 0\n'
    run = recorded(periph_sim, tmp_path, CONSOLE_C, "110 ms", "SCI-C", NO_STALLS + case, status=1)
    [(began, text)] = sent(periph_sim, run, "SCI-C.TX", 9600)
    assert (text, began) == (BANNER, pytest.approx(4.437e-3, abs=SCICLK))
    out = periph_sim("run", str(tmp_path / "case.toml")).out
    assert re.search(r"waits for SCI-C\.SCIRXST\.RXRDY at \w+ \([\w.:, ]+\) since 106\.", out)


def test_a_console_with_rs_485_switches_its_driver_off_too_early(periph_sim: Run, tmp_path: Path):  # noqa: F811
    """The program waits for TXRDY, not TXEMPTY, before it clears GPIO49 (scib_msg, 0x85FE): two characters are lost."""
    pins = 'pins = { DE = 49, "SCI-B.TX" = 22, "SCI-B.RX" = 23 }\n[[transceiver]]\non = "dsp.SCI-B"\nde = "DE"\n'
    case = f'{pins}[serial]\nbaud = 9600\n[[serial.send]]\nto = "dsp.SCI-B"\ntext = "A"\nat = "120 ms"\n'
    run = recorded(periph_sim, tmp_path, CONSOLE_B, "160 ms", "SCI-B", case, status=1)
    bursts = sent(periph_sim, run, "SCI-B.TX", 9600)
    assert [text for _, text in bursts] == [BANNER, b"  You sent: A\r\nEnter a character: "]
    assert bursts[0][0] == pytest.approx(4.437e-3 + 12 * US, abs=SCICLK)
    began = bursts[0][0]
    assert 0 < began - first_rise(recorded_as(periph_sim, tmp_path, ".vcd"), "DE") < SCICLK
    text = periph_sim("run", str(tmp_path / "case.toml")).out
    assert "RS485: DE switches the driver of dsp.SCI-B off before its frame is over, first at 20.07" in text
    assert "RS485: dsp.SCI-B sends a frame while DE holds its driver off, first at 107.5" in text


def test_a_clock_is_set_byte_by_byte_from_interrupts(periph_sim: Run, tmp_path: Path):  # noqa: F811
    """Each STOP and the pointer's ARDY cause an interrupt. The read is a second, 30 M passes of DELAY_US, later."""
    more = '[device.clock]\nmodel = "isl12026"\n' + CLEAN
    run = recorded(periph_sim, tmp_path, CLOCK, "16 ms", "I2C-A", NO_STALLS + more)
    written = ("3F 02", "3F 06", "37 20", "35 07", "34 12", "33 03", "36 01", "32 15", "31 39", "30 50")
    rows = transfers(periph_sim, run)
    assert [row for _, row in rows] == [*(f"S 6F W 00 {pair} P" for pair in written), "S 6F W 00 30"]
    assert acknowledged(periph_sim, run)[0] == pytest.approx(4.4984e-3, abs=TOLERANCE)
    assert {round(after - before, 6) for (before, _), (after, _) in pairwise(rows)} <= {0.001095, 0.001096}
    calls = '[[budget]]\nname = "interrupts"\nmeasure = "calls of i2c_int1a_isr"\nexactly = 11\n'
    run = recorded(periph_sim, tmp_path, CLOCK, "16 ms", "I2C-A", more + calls)
    assert 17 * US < acknowledged(periph_sim, run)[0] - 4.4984e-3 < 19 * US


def test_a_clock_is_read_back_after_a_second(periph_sim: Run, tmp_path: Path):  # noqa: F811
    """HR = 0x15 without MIL is no hour of a 12-hour clock, so the clock does not count from there."""
    if form.running == form.INTERPRETED:
        pytest.skip("150 million cycles of a delay are for the compiled form: `make core`")
    more = '[device.clock]\nmodel = "isl12026"\n' + CLEAN
    run = recorded(periph_sim, tmp_path, CLOCK, "1020 ms", "I2C-A", more)
    began, row = transfers(periph_sim, run)[10]
    assert row == "S 6F W 00 30 Sr 6F R 50 39 15 03 12 07 01 20 N P"
    assert began == pytest.approx(15.45e-3, abs=2 * US)


def test_a_clock_hangs_where_pieack_is_all_ones_after_the_reset(periph_sim: Run, tmp_path: Path):  # noqa: F811
    more = '[unit.dsp.options.system]\npieack_reset = 0xFFF\n[device.clock]\nmodel = "isl12026"\n'
    more += '[[budget]]\nname = "interrupts"\nmeasure = "count of interrupt I2CINT1A enter"\nexactly = 0\n'
    run = recorded(periph_sim, tmp_path, CLOCK, "16 ms", "I2C-A", more, status=1)
    assert [row for _, row in transfers(periph_sim, run)] == ["S 6F W 00 3F 02 P"]
    text = periph_sim("run", str(tmp_path / "case.toml")).out
    assert (
        "dsp waits for _I2cMsgOut1 at WriteData (i2c_rtc.c:480, 0x008528) since 4494.147 us and would for ever" in text
    )


def test_leds_light_up_one_after_the_other_and_toggle_each_half_second(periph_sim: Run, tmp_path: Path):  # noqa: F811
    """TINT0 toggles the LEDs: rises of an LED are a second apart, and it is lit for half of that time."""
    pins = "pins = { L0 = 0, L1 = 1, L2 = 2, L3 = 3, L4 = 4 }\n"
    blink = 'rate = "1 Hz"\nduty = "50 %"\nafter = "5 ms"\nfirst = "1010 ms"\ntolerance = "0.5 us"\n'
    watch = "".join(f'[watch.L{n}]\nkind = "blink"\nwire = "L{n}"\n{blink}' for n in range(5))
    interrupts = '[[budget]]\nname = "toggles"\nmeasure = "count of interrupt TINT0 enter"\nexactly = 5\n'
    recorded(periph_sim, tmp_path, LEDS, "2510 ms", "SCI-A", pins + watch + interrupts)
    vcd = recorded_as(periph_sim, tmp_path, ".vcd")
    at = [first_rise(vcd, f"L{n}") for n in range(5)]
    assert [after - before for before, after in pairwise(at)] == [pytest.approx(10.06e-6, abs=0.02e-6)] * 4


def test_an_echo_with_the_fpu_answers_a_line_100_ms_later(periph_sim: Run, tmp_path: Path):  # noqa: F811
    """The program uses GPIO35 and 36, and checks for characters every 200 ms, in the interrupt of timer 0."""
    pins = "pins = { RX = 36, TX = 35 }\n"
    serial = '[serial]\nbaud = 4800\n[[serial.send]]\nname = "hi"\nto = "dsp.SCI-A"\ntext = "hi\\n"\nat = "400 ms"\n'
    serial += '[[serial.expect]]\nname = "echo"\nfrom = "dsp.SCI-A"\ntext = "  You sent: hi\\n"\nafter_send = "hi"\n'
    serial += 'within = "130 ms"\n[[budget]]\nname = "TINT0"\nmeasure = "count of interrupt TINT0 enter"\nexactly = 3\n'
    run = recorded(periph_sim, tmp_path, ECHO, "650 ms", "SCI-A", pins + NO_STALLS + serial)
    bursts = sent(periph_sim, run, "TX", 4800)
    assert [text for _, text in bursts] == [HELLO, b"  You sent: hi\n"]
    assert bursts[0][0] == pytest.approx(4.505e-3, abs=TOLERANCE)
    assert bursts[1][0] > 0.5


def test_a_sender_sends_a_character_every_10_ms(periph_sim: Run, tmp_path: Path):  # noqa: F811
    """The first bit clock is short, because the divisor is written in two halves.

    SCIHBAUD = 1 is written a cycle before SCILBAUD = 231. If LSPCLK, of 4 cycles, has its edge between the two writes,
    the first bit clock takes 257 LSPCLK instead of 488. This is the case here, as DINT takes 2 cycles, not 1.
    """
    run = recorded(periph_sim, tmp_path, SENDER, "26 ms", "SCI-A", NO_STALLS, status=1)
    came = sent(periph_sim, run, "TX", 9600)
    assert [text for _, text in came] == [b"s"] * 3
    assert came[0][0] == pytest.approx(4.457e-3 - (488 - 257) * 4 / SYSCLK, abs=TOLERANCE)
    stalled = sent(periph_sim, recorded(periph_sim, tmp_path, SENDER, "26 ms", "SCI-A", "", status=1), "TX", 9600)
    assert 0 < stalled[0][0] - came[0][0] < SCICLK + (488 - 257) * 4 / SYSCLK
    for begins in (came, stalled):
        assert {9.994e-3 <= after - before <= 10.0075e-3 for (before, _), (after, _) in pairwise(begins)} == {True}


def test_the_other_build_of_the_sender_sets_300_mhz_and_is_twice_as_fast(periph_sim: Run, tmp_path: Path):  # noqa: F811
    """The build is said to have S8's source, but has other settings: 5 ms at 19200 baud instead of 10 ms at 9600.

    InitSysCtrl calls InitPll(10, 3) at 0x931a, where S8 calls InitPll(10, 2): PLLSTS.DIVSEL = 3 divides by 1, so
    SYSCLKOUT is 300 MHz, which SPRUFB0D Table 22 forbids and the run reports. delay_us(10000) makes 30 passes of 5
    cycles a microsecond, as for 150 MHz, and SCILBAUD is that of S8.
    """
    run = recorded(periph_sim, tmp_path, OVERCLOCKED, "26 ms", "SCI-A", "", status=1)
    came = sent(periph_sim, run, "TX", 19200)
    assert [text for _, text in came] == [b"s"] * 5
    assert {4.994e-3 <= after - before <= 5.0045e-3 for (before, _), (after, _) in pairwise(came)} == {True}
    text = periph_sim("run", str(tmp_path / "case.toml")).out
    assert "PLLSTS.DIVSEL = 3 with PLLCR = 10; it is allowed with PLLCR = 0 only" in text


def first_send(image: str, folder: Path, module: str, more: str) -> Fraction:
    """Return when the first character is written to SCITXBUF or the first START is commanded, in seconds."""
    (folder / "case.toml").write_text(CASE.format(duration="5 ms", image=public_image(image), module=module) + more)
    scene, accesses = runs.recorded(load(folder / "case.toml"), {Kind.ACCESS})
    scene.run(Fraction("0.005"))
    sends = (
        one.tick
        for one in accesses
        if one.what == "W SCI-A.SCITXBUF" or (one.what == "W I2C-A.I2CMDR" and one.value & STT)
    )
    return Fraction(scene.timebase.seconds(next(sends)))


@pytest.mark.parametrize(
    ("image", "module", "more", "slow", "passes", "fast"),
    [
        (CONSOLE, "SCI-A", "", 22 + 6, 128 * 9, 28),
        (EEPROM, "I2C-A", '[device.memory]\nmodel = "24c02"\n', 22 + 11, 0, 11),
        (CLOCK, "I2C-A", '[device.clock]\nmodel = "isl12026"\n', 67 + 3, 128 * 9, 50),
        (SENDER, "SCI-A", "", 27 + 5, 128 * 5, 16),
    ],
)
def test_stalls_lengthen_the_start_up_by_exactly_these_cycles(
    tmp_path: Path, image: str, module: str, more: str, slow: int, passes: int, fast: int
):
    """slow: stalls before the PLL has locked, at 7.5 MHz. passes: of InitPieVectTable's loop. fast: all others.

        row  _c_int00, others  at 133.3 ns   128 passes   others  at 6.67 ns        later by
        S1            22 +  6      3.733 us    9 cycles       28    7.867 us       11.600 us
        S4            22 + 11      4.400 us     (memcpy)      11    0.073 us        4.473 us
        S5            67 +  3      9.333 us    9 cycles       50    8.013 us       17.347 us
        S8            27 +  5      4.267 us    5 cycles       16    4.373 us        8.640 us

    At 7.5 MHz most stalls are in .cinit's loop: PREAD AL,*XAR7 after MOVL XAR7,ACC (3) and BANZ AR1 after MOVZ AR1,AL
    (2), 13 and 14 times in S5. A pass of InitPieVectTable's loop has MOVL XAR6,*XAR4++ after a load of XAR4 (3), MOVL
    ACC,XAR4 after another load (3) and a read of the index after its INC (3). S8's compiler loads one pointer early and
    leaves an instruction between the other's load and use (2). XARn is loaded in E and read in D2, as a pointer or not
    [SPRU430F 4.4.2; TI wiki "C28x Pipeline Conflicts" 1.3, 2.1]; a word is written in W and read in R1 [SPRU430F
    4.4.1]. TI's own counts of IQmath have the same stalls (test_published_cycles).
    """
    later = first_send(image, tmp_path, module, more) - first_send(image, tmp_path, module, NO_STALLS + more)
    assert later * SYSCLK == slow * 20 + passes + fast


def test_a_lab_that_starts_a_transfer_as_slave_puts_nothing_on_the_bus(periph_sim: Run, tmp_path: Path):  # noqa: F811
    """I2CMDR = 0x6220 (I2C_SendCommand, 0x948A): STT without MST, so it waits for SCD until the watchdog resets it."""
    run = recorded(periph_sim, tmp_path, LAB, "290 ms", "I2C-A", CLEAN)
    assert transfers(periph_sim, run) == []
    text = periph_sim("run", str(tmp_path / "case.toml")).out
    assert "its watchdog reset it at I2C_SendCommand (Lab12_4 copy.c:105, 0x00948d), first at 281.80" in text
    recorded_as(periph_sim, tmp_path, ".psr")
    assert "writes I2CCNT as slave" in periph_sim("lint", str(tmp_path / "run.psr")).out


def test_a_key_of_a_keypad_is_sent_repeatedly_while_it_is_pressed(periph_sim: Run, tmp_path: Path):  # noqa: F811
    """A key connects a column, which is driven low in its turn, with a row."""
    key = '[[cable]]\nname = "KEY5"\nfrom = "dsp.GPIO25"\nto = "dsp.GPIO20"\n'
    run = recorded(periph_sim, tmp_path, KEYPAD, "210 ms", "SCI-A", key, status=1)
    assert sent(periph_sim, run, "TX", 115200) == [
        (pytest.approx(104.45e-3, abs=1e-4), b"5"), (pytest.approx(204.45e-3, abs=1e-4), b"5")
    ]  # fmt: skip


def test_a_monitor_that_erases_flash_is_stopped_at_the_flash_api(periph_sim: Run, tmp_path: Path):  # noqa: F811
    more = 'boot = "flash"\npins = { RX = 36, TX = 35 }\n[serial]\nbaud = 115200\n'
    for key, at in (("x", 20), ("A", 600)):
        more += f'[[serial.send]]\nto = "dsp.SCI-A"\ntext = "{key}"\nat = "{at} ms"\n'
    run = recorded(periph_sim, tmp_path, MONITOR, "700 ms", "SCI-A", more, status=1)
    assert b"Erase All Flash Sector" in sent(periph_sim, run, "TX", 115200)[-1][1]
    came = periph_sim("run", str(tmp_path / "case.toml"))
    assert came.status == 1
    [text] = [line for line in came.out.splitlines() if line.startswith("stuck: ")]
    assert "0x3fffb9 of the boot ROM is read: erasing and programming flash, as TI's flash API does, is not mod" in text
    assert "Erase_AllFlash 0x339324, Flash28335_Erase 0x000126" in text
