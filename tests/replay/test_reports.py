"""Complete reports, one of each kind of replay: every value, message and note that is not a default."""

from __future__ import annotations

from dataclasses import asdict, fields
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.replay import replay
from periph_sim.replay.i2c_closed_loop import I2cReplay
from periph_sim.replay.i2c_master import I2cMasterReplay
from periph_sim.replay.i2c_open_loop import I2cOpenReplay
from periph_sim.replay.report import Report
from periph_sim.replay.uart import UartReplay, line_format
from periph_sim.scene.case.load import load
from periph_sim.traces.formats import Capture
from tests.replay.slow import slow_case
from tests.replay.test_agents import OTHER, OWN, THEIR_TIME, line, reads, shipped
from tests.replay.test_as_master import wave_of
from tests.scene.runs import TIMING
from tests.traces.decode.drawing import of_bytes
from tests.traces.formats.writers import frame_bits, uart_wave

US = Fraction(1, 10**6)
WRITTEN = (
    "byte 9: data read A5 at 625.00 us, data read A7 at {} us; I2CDXR = 0xA7 was written at "
    f"slow.py:{line('I2CDXR')}, in main"
)


@pytest.fixture(autouse=True)
def clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """Set the wall clock to 100 s at the start of a run and 2.5 s later at its end; microseconds are reported."""
    monkeypatch.setattr(replay, "perf_counter", iter((100.0, 102.5000124)).__next__)


def fields_of(report: Report) -> dict[str, object]:
    """Return the fields that differ from their defaults, with values to 0.1 ns and a divergence in one line.

    Fields that depend on the kernel, and the chip's open questions, are left out.
    """
    defaults = {
        one.name: one.default_factory() if callable(one.default_factory) else one.default for one in fields(Report)
    }
    found: dict[str, object] = {}
    for name, default in defaults.items():
        value = getattr(report, name)
        if value != default and name not in ("kernel_events", "unknowns", "case", "capture"):
            found[name] = round(value, 4) if isinstance(value, float) and name != "wall_s" else value
    found["simulated_s"] = round(report.simulated_s, 8)
    found["divergences"] = [
        f"{one.kind} {one.index}: {one.expected} at {one.capture_s * 1e6:.2f} us, "
        f"{one.found} at {one.replay_s * 1e6:.2f} us; {one.cause}"
        for one in report.divergences
    ]
    first = report.first_divergence
    assert report.kernel_events > 0 and all(one.history for one in report.divergences)
    found["first_divergence"] = first and f"{first.kind} {first.index}"
    return found


def test_values_that_are_not_given_are_empty():
    report = Report("case", "capture", "i2c", "pass", 3, 2, None, 1)
    lists = ("filled", "divergences", "addresses", "budgets", "unknowns", "notes", "busy_us", "captured_busy_us")
    counts = ("captured_events", "transfers", "captured_transfers", "captured_errors", "ambiguous", "nacks")
    counts += ("refusals", "captured_refusals")
    times = ("tolerance_us", "stretch_worst_us", "stretch_total_us", "captured_stretch_us", "late_worst_us")
    more = ("lag_worst_us", "lag_samples", "simulated_s", "wall_s", "kernel_events")
    assert asdict(report) == {
        "case": "case",
        "capture": "capture",
        "kind": "i2c",
        "verdict": "pass",
        "events": 3,
        "agreed": 2,
        "first_divergence": None,
        "bytes": 1,
        "unjudged": "",
        "loop": "closed",
        "role": "slave",
        "errors": {},
        **{name: [] for name in lists},
        **dict.fromkeys((*counts, *times, *more), 0),
    }


def mixed_reads() -> Capture:
    """Return three reads: a stretch of 25 us by another target, one of 100 us before a wrong byte, and no stretch."""
    return reads((OTHER, 0x33, 100), (OWN, 0xA5, 400), (OWN, 0xA7, 0))


NOT_FILLED = (
    "settings of {}/slow.py that are not filled in from the capture, since its module does not name them in REPLAY: "
    "address"
)


def test_the_report_of_a_closed_loop(tmp_path: Path):
    """--longest-low cuts the agents' stretch; the firmware computes for 100 us before each of its bytes."""
    progress: list[float] = []
    case = load(slow_case(tmp_path), ["unit.dsp.settings.wait=100"])
    given = {"addresses": [OWN], "longest_low": 5 * US, "tolerance": US}
    report = I2cReplay(case, mixed_reads(), "SCL", "SDA", **given).run(progress.append)
    assert progress == [1.0] and (report.case, report.capture) == ("slow", "samples")
    assert fields_of(report) == {
        "wall_s": 2.500012,
        "kind": "i2c",
        "verdict": "not judged",
        "events": 18,
        "agreed": 17,
        "first_divergence": "byte 9",
        "bytes": 6,
        "captured_events": 18,
        "transfers": 3,
        "captured_transfers": 3,
        "unjudged": THEIR_TIME,
        "divergences": [
            WRITTEN.format("610.35"),
            f"timing 3: data read 33 at 225.00 us, data read 33 25.000 us earlier at 200.00 us; {THEIR_TIME}",
        ],
        "tolerance_us": 1.0,
        "addresses": ["50"],
        "nacks": 3,
        "stretch_worst_us": 85.3533,
        "stretch_total_us": 170.7067,
        "captured_stretch_us": 100.0,
        "lag_worst_us": 25.0,
        "lag_samples": 100.0,
        "simulated_s": 0.00220535,
        "notes": [NOT_FILLED.format(tmp_path), "an agent answers for 51, as captured"],
    }


def test_the_report_of_an_open_loop(tmp_path: Path):
    """The firmware needs half of the captured stretch, and 45 us more than the last read has."""
    progress: list[float] = []
    case = load(slow_case(tmp_path), ["unit.dsp.settings.wait=60"])
    report = I2cOpenReplay(case, mixed_reads(), "SCL", "SDA", addresses=[OWN]).run(progress.append)
    assert progress == [step / 100 for step in range(1, 101)]
    assert fields_of(report) == {
        "wall_s": 2.500012,
        "kind": "i2c",
        "loop": "open",
        "verdict": "fail",
        "events": 18,
        "agreed": 17,
        "first_divergence": "byte 9",
        "bytes": 6,
        "captured_events": 18,
        "transfers": 3,
        "captured_transfers": 3,
        "divergences": [
            WRITTEN.format("625.00"),
            "timing 15: SCL rises for byte 1 bit 0 at 925.00 us, SCL held for another 45.380 us at 970.38 us; "
            f"the firmware was at slow.py:{line('thinking')}, in main",
        ],
        "tolerance_us": 0.2567,
        "addresses": ["50"],
        "nacks": 3,
        "stretch_worst_us": 50.38,
        "stretch_total_us": 100.7333,
        "captured_stretch_us": 100.0,
        "late_worst_us": 45.38,
        "simulated_s": 0.002235,
        "notes": [
            NOT_FILLED.format(tmp_path),
            "long low phases of SCL that the chip would have ended earlier: 1 of 1; that at 0.000625 s lasts "
            "105.000 us, and the chip needs 50.353 us",
            "stretches that the chip would have made and the capture lacks: 1; the longest 45.380 us past SCL's rise "
            "at 0.000925 s",
        ],
    }


def test_the_report_of_a_master():
    """Its script differs from the capture in one byte; a transfer that it cannot make is left out."""
    progress: list[float] = []
    wave = wave_of("S A0+ ~400 00+ P S A1+ P S A0+ 11+ Sr A1+ 33- P S A2- P")
    capture = wave.capture(4_000_000)
    case = load(TIMING / "captured_master.toml", ["unit.dsp.settings.script=['50 W 01', '50 W 11 Sr 50 R 1']"])
    report = I2cMasterReplay(case, capture, "SCL", "SDA", first=3).run(progress.append)
    assert progress == [1.0]
    notes = report.notes
    assert notes.pop().startswith("dsp: main returned at ")
    assert fields_of(report) == {
        "wall_s": 2.500012,
        "kind": "i2c",
        "role": "master",
        "verdict": "fail",
        "events": 17,
        "agreed": 16,
        "first_divergence": "byte 3",
        "bytes": 6,
        "captured_events": 25,
        "transfers": 2,
        "captured_transfers": 4,
        "filled": ["pauses", "low", "high"],
        "divergences": [
            "byte 3: data write 00 at 300.00 us, data write 01 at 300.79 us; "
            f"I2CDXR = 0x01 was written at {shipped('captured_master.py', 'I2CDXR.all')}, in write"
        ],
        "addresses": ["50"],
        "nacks": 1,
        "captured_stretch_us": 100.0,
        "lag_worst_us": 0.7867,
        "lag_samples": 3.1467,
        "simulated_s": 0.0251,
        "notes": [
            "omitted transfers, which this module cannot do as master: "
            "1 (a read of no byte, whose address was acknowledged)"
        ],
    }


def test_the_report_of_a_serial_line():
    """At 100 kBd: 41; a break; 4F with a glitch; 42 without its stop bit; 43; a frame that the capture cuts off."""
    progress: list[float] = []
    bit = Fraction(20)  # samples
    shapes = {40: frame_bits(0x41), 280: [0] * 13, 600: frame_bits(0x4F), 840: [*frame_bits(0x42)[:-1], 0]}
    shapes |= {1100: frame_bits(0x43), 1400: frame_bits(0x44)}
    samples = bytearray(uart_wave([(Fraction(at), bits) for at, bits in shapes.items()], bit, 1500))
    samples[600 + 5 * 20 + 10] ^= 1
    capture = of_bytes(bytes(samples), ("RX",), 2_000_000)
    case = load(TIMING / "uart_logger.toml")
    report = UartReplay(case, capture, "RX", line_format(100_000)).run(progress.append)
    assert progress == [step / 100 for step in range(1, 101)]
    assert fields_of(report) == {
        "wall_s": 2.500012,
        "kind": "uart",
        "loop": "open",
        "verdict": "not judged",
        "events": 5,
        "agreed": 4,
        "first_divergence": None,
        "bytes": 5,
        "captured_errors": 1,
        "ambiguous": 1,
        "unjudged": "read at 100000 baud, 8n1, 1 of 5 frames in the capture (20.0%) have framing or parity errors; "
        "expected few; check rate, format and polarity of the line",
        "divergences": [],
        "errors": {"FE": 2, "PE": 0, "BRKDT": 0, "OE": 0, "RXFFOVF": 0},
        "lag_worst_us": 100.3,
        "simulated_s": 0.00175,
        "notes": [
            "frames with a glitch, which receivers may read either way, not judged: 1 of 5, "
            "the first at 0.000300 s, 5F where each bit is sampled once",
            "frames cut off by the end of the capture, not compared: 1, the last with 4 data bits",
            "low for a frame or longer, 13.0 bits at most: 1 time",
            "dsp SCI-A, first at 1337.820 us: RX was low for longer than a character, but rose before BRKDT, which "
            "needs ten low bits after the missing stop bit; a break of LIN has 13 in all [SPRUFZ5A T2-7]",
        ],
    }
