"""Real captures are decoded to the same events as by an independent decoder (the oracle), whose output is beside them.

Kind, value and first sample are compared; the oracle's last samples are guesses. The oracle does not report incomplete
bytes, so these are counted separately, in CUT_BYTES.
"""

from __future__ import annotations

import csv
import re
from collections import Counter
from fractions import Fraction
from functools import cache

import pytest

from periph_sim.traces import formats
from periph_sim.traces.decode import i2c, uart
from periph_sim.traces.decode.uart import uart_table
from periph_sim.traces.decode.uart_doubt import rate_doubt
from periph_sim.traces.decode.uart_guess import guess
from periph_sim.traces.formats import Capture
from tests.captures.where import FOLDER, capture_of, decoded, needs_captures, oracle, remarks
from tests.traces.decode.drawing import Plain, plain

# The sampling rate of files that only have times.
RATES = {
    "i2c_ds3231_ex2_vcd": 4_000_000,
    "i2c_mdfu_stretch_csv": 125_000_000,
    "i2c_mdfu_write_csv": 125_000_000,
    "i2c_slow_slave": 125_000_000,
    "i2c_nunchuk_init_simvcd": 1_000_000,
    "uart_async115200_csv": 500_000_000,
    "uart_hello_8n1_115200_vcd": 1_000_000,
    "uart_mdfu_client_info": 125_000_000,
}

# Files whose channels have other names than those in the oracle's command, which was run on the source file.
NAMES = {
    "i2c_nunchuk_init_simvcd": {"SCL": "scl", "SDA": "sda"},
    "uart_async115200_csv": {"RX": "Channel 0"},
    "uart_mdfu_client_info": {"RX": "digital_0", "TX": "digital_1"},
}

# Incomplete bytes, which only this decoder reports: the only difference in the events of I2C.
CUT_BYTES = {
    "i2c_24aa025uid_busy_2ms": 64,  # after the NACK the master makes one clock with SDA low, then a repeated START
    "i2c_mcp23017_counter_a": 1,  # the capture ends within a byte
    "i2c_eeprom_busy": 1,  # so does this one
}

# Files in which the oracle's start bits are one sample after the start edges of this decoder: it subtracts half a bit,
# truncated to whole samples, from the middle of the bit, which is rounded up.
ONE_SAMPLE_LATE = {
    "uart_es51978_2400_7o1",
    "uart_glitch_0x20",
    "uart_glitch_0x45",
    "uart_glitch_0x4f_2",
    "uart_hello_8n1_921600",
    "uart_hello_8n1_9600",
    "uart_kern_1200",
    "uart_glitch_4f",
}

TOO_LARGE = "i2c_cat24c256_flash_1M_edges"  # the oracle's file has only the first 200 lines, and counts


@cache
def load(name: str) -> Capture:
    """Return the capture, which is read once for all tests; none of them changes it."""
    rate = RATES.get(name)
    return formats.read(capture_of(name), None if rate is None else Fraction(rate))


def options(name: str, kind: str) -> dict[str, str]:
    """Return the decoder's options in the oracle's command, such as scl=SCL:sda=SDA."""
    match = re.search(rf"-P '?{kind}:(.*?)'? -A", remarks(name, kind))
    assert match, f"{name}: no command at the head of the decode"
    return dict(option.split("=") for option in match[1].split(":"))


def channel(name: str, called: str) -> str:
    return NAMES.get(name, {}).get(called, called)


def i2c_lines(events: list[Plain]) -> list[tuple[int, str]]:
    """Return events as the oracle writes them; incomplete bytes are omitted."""
    lines: list[tuple[int, str]] = []
    for event in events:
        match event:
            case ("START", at):
                lines.append((at, "Start"))
            case ("REPEATED_START", at):
                lines.append((at, "Start repeat"))
            case ("ADDRESS", at, value, read, rw_at):
                way = "read" if read else "write"
                lines += [(rw_at, way.capitalize()), (at, f"Address {way}: {value:02X}")]
            case ("DATA", at, value, read):
                lines.append((at, f"Data {'read' if read else 'write'}: {value:02X}"))
            case ("ACK" | "NACK" as answer, at):
                lines.append((at, answer))
            case ("STOP", at):
                lines.append((at, "Stop"))
    return lines


@pytest.mark.parametrize("name", [name for name in decoded("i2c") if name != TOO_LARGE])
def test_i2c_events_equal_those_of_the_oracle(name: str):
    given = options(name, "i2c")
    events = i2c.events(load(name), channel(name, given["scl"]), channel(name, given["sda"]))
    assert i2c_lines(plain(events)) == [(said.at, said.text) for said in oracle(name, "i2c")]
    assert sum(event.kind.name == "CUT" for event in events) == CUT_BYTES.get(name, 0)


@needs_captures
def test_i2c_events_of_a_million_edges_equal_those_of_the_oracle():
    events = i2c.events(load(TOO_LARGE))
    lines = i2c_lines(plain(events))
    first = [(said.at, said.text) for said in oracle(TOO_LARGE, "i2c")]
    assert lines[: len(first)] == first and len(first) == 200
    counts = dict(re.findall(r"([A-Za-z ]+)=(\d+)", remarks(TOO_LARGE, "i2c").split("# counts: ")[1]))
    assert Counter(text.partition(":")[0] for _, text in lines) == {k.strip(): int(v) for k, v in counts.items()}


def uart_lines(events: list[uart.Event], line: uart.Line, late: int) -> list[tuple[str, int | None]]:
    """Return the oracle's annotations of one channel, with the sample of the start edge for those that have it."""
    lines: list[tuple[str, int | None]] = []
    for event in events:
        match event.kind.name:
            case "FRAME":
                lines.append(("Start bit", event.at + late))
                lines.append((f"{event.value:0{-(-line.bits // 4)}X}", None))
                if line.parity != "none":
                    lines.append(("Parity error" if event.parity_error else "Parity bit", None))
                if event.frame_error:
                    lines.append(("Frame error", None))
                lines.append(("Stop bit", None))
            case "BREAK":
                lines.append(("Break condition", event.at + late))
    return lines


@pytest.mark.parametrize("name", decoded("uart"))
def test_only_a_wrong_rate_gives_a_warning_which_names_the_right_one(name: str):
    """Captures of one or two bytes have too few frames for a warning."""
    given = options(name, "uart")
    capture, baud = load(name), int(given["baudrate"])
    line = uart.Line(baud, int(given.get("data_bits", "8")), given.get("parity", "none"))
    for wire in (channel(name, given[side]) for side in ("rx", "tx") if side in given):
        assert rate_doubt(capture, wire, line) is None
        wrong = [uart.Line(round(baud * factor)) for factor in (0.5, 0.9, 1.1, 1.5)]
        named = [doubt[1].baud for one in wrong if (doubt := rate_doubt(capture, wire, one))]
        assert named == [baud] * len(named)
        assert len(named) >= 2 or len(capture.channel(wire).edges) <= 10


@pytest.mark.parametrize("name", decoded("uart"))
def test_uart_frames_equal_those_of_the_oracle(name: str):
    given = options(name, "uart")
    line = uart.Line(int(given["baudrate"]), int(given.get("data_bits", "8")), given.get("parity", "none"))
    late = int(name in ONE_SAMPLE_LATE)
    capture = load(name)
    wires = [channel(name, given[side]) for side in ("rx", "tx") if side in given]
    found = [uart.events(capture, wire, line) for wire in wires]
    ours = [uart_lines(events, line, late) for events in found]
    said = [
        (what.text, what.at if what.text in ("Start bit", "Break condition") else None) for what in oracle(name, "uart")
    ]
    assert is_merge(said, ours)


# Files in which the guess from edges alone differs from the oracle's options.
GUESSED_OTHERWISE = {
    "uart_glitch_0x20": "one byte, and its shortest pulses are glitches",
    "uart_glitch_0x45": "one byte, and its shortest pulses are glitches",
    "uart_glitch_0x4f_2": "one byte, and its shortest pulses are glitches",
    "uart_glitch_4f": "one byte, and its shortest pulses are glitches",
    "uart_toim_57600_snippet": "ten bytes, all of even parity: 7e1 fits as well as 8n1",
    "uart_ut61e_19200_7o1": "five different bytes are too few to believe 7o1, which is named beside 8n1",
}


@pytest.mark.parametrize("name", decoded("uart"))
def test_guessed_rate_and_frame_equal_the_options_of_the_oracle(name: str):
    given = options(name, "uart")
    given_line = uart.Line(int(given["baudrate"]), int(given.get("data_bits", "8")), given.get("parity", "none"))
    capture = load(name)
    for side in ("rx", "tx"):
        if side in given:
            found = guess(capture, channel(name, given[side]))
            assert (found.line == given_line) == (name not in GUESSED_OTHERWISE), found
            if name.startswith("uart_glitch"):
                assert found.sure < 0.5
            else:
                assert found.line.baud == given_line.baud and {given_line.shape} <= {found.line.shape, *found.also}


def is_merge(whole: list[tuple[str, int | None]], parts: list[list[tuple[str, int | None]]]) -> bool:
    """True if `whole` interleaves `parts`, each in its own order; the oracle does not name the channel."""
    if len(parts) == 1:
        return whole == parts[0]
    left, right = parts
    reachable = {0}  # how many items of `left` may have been used after each item
    for done, item in enumerate(whole):
        reachable = {n + 1 for n in reachable if n < len(left) and left[n] == item} | {
            n for n in reachable if done - n < len(right) and right[done - n] == item
        }
    return len(left) in reachable and len(whole) == len(left) + len(right)


@needs_captures
def test_the_decoder_of_the_vendor_finds_the_same_bytes_at_the_same_instants():
    capture = load("uart_async115200_csv")
    frames = uart.events(capture, 0, uart.Line(115200))
    with (FOLDER / "uart_async115200_csv.saleae.csv").open() as file:
        rows = list(csv.DictReader(file))
    theirs = [(round(Fraction(row["start_time"]) * 500_000_000), int(row["data"], 16)) for row in rows]
    assert [(f.at, f.value) for f in frames if f.kind.name == "FRAME"] == theirs and len(theirs) == 2240


SENT = {"uart_glitch_0x20": 0x20, "uart_glitch_0x45": 0x45, "uart_glitch_0x4f_2": 0x4F, "uart_glitch_4f": 0x4F}


@pytest.mark.parametrize("name", [name for name in decoded("uart") if name in SENT])
def test_a_vote_of_three_samples_reads_a_byte_with_a_glitch_as_it_was_sent(name: str):
    (event,) = uart.events(load(name), "RX", uart.Line(115200), vote=True)
    if event.kind.name == "FRAME":
        assert (event.value, event.glitched) == (SENT[name], True)
    else:  # the capture ends before the last sample of the stop bit
        assert event.kind.name == "CUT"
        assert event.value == SENT[name]


@pytest.mark.parametrize("name", [name for name in decoded("uart") if "glitch" not in name])
def test_no_frame_of_a_clean_line_is_marked_as_glitched(name: str):
    given = options(name, "uart")
    line = uart.Line(int(given["baudrate"]), int(given.get("data_bits", "8")), given.get("parity", "none"))
    for side in ("rx", "tx"):
        if side in given:
            table = uart_table(load(name), channel(name, given[side]), line)
            assert not table.glitched.any() and not table.unsure.any()


@needs_captures
def test_transfers_of_a_sensor_poll_have_the_times_that_a_replay_needs():
    capture = load("i2c_trekstor_accel_pmic_rtc")
    found = i2c.transfers(capture)
    assert len(found) == 66 and all(transfer.complete for transfer in found)
    assert {phase.address for transfer in found for phase in transfer.phases} == {0x15, 0x34, 0x51}
    assert [transfer.gap is None for transfer in found] == [True] + [False] * 65
    for transfer in found:
        bits = [bit for phase in transfer.phases for byte in phase.bytes for bit in byte.bits]
        assert all(bit.low is not None and bit.high is not None for bit in bits)


@needs_captures
def test_transfers_that_exceed_the_capture_are_marked():
    begun_before = i2c.transfers(load("i2c_24aa025uid_trigger_sda_low"))
    assert not begun_before[0].complete and len(begun_before[0].lead) == 28
    assert [transfer.complete for transfer in begun_before[1:]] == [True] * 7
    not_ended = i2c.transfers(load("i2c_mcp23017_counter_a"))
    assert [transfer.complete for transfer in not_ended] == [True] * 96 + [False]


@needs_captures
def test_a_stretch_of_four_milliseconds_is_the_low_phase_of_the_ninth_bit():
    capture = load("i2c_mdfu_stretch_csv")
    ninth = [phase.bytes[0].bits[8] for transfer in i2c.transfers(capture) for phase in transfer.phases]
    assert [bit.low for bit in ninth] == [507161, 505359, 503915]  # at 125 MHz
    assert [bit.value for bit in ninth] == [1, 1, 1]
