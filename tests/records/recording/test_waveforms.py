"""Waveforms of a run: their signals as drawings with 100 ns per character, and files as other programs read them."""

from __future__ import annotations

import shutil
import sys
from fractions import Fraction
from io import StringIO
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest
import pywellen

from periph_sim.core.records import Kind, Recorder
from periph_sim.core.time import Timebase
from periph_sim.records.recording import BadRecording, recording
from periph_sim.records.recording.waveforms import KINDS, WaveformWriter, rate_for
from periph_sim.scene.case.load import load
from periph_sim.traces import formats
from periph_sim.traces.decode import i2c, uart
from tests.records.scenes import MODULES, recorded_to, written
from tests.records.vcdvcd_reader import VCDVCD
from tests.traces.decode.drawing import drawn
from tests.traces.formats.sigrok import sigrok_says

TIMING = Path(__file__).resolve().parents[3] / "timing"
CHARACTER = 300  # ticks
Others = list[tuple[int, Kind, str, str, int]]  # character, kind, where, what, value


def check(lines: str, others: Others, shown: str) -> None:
    """Check the signals of a run.

    lines: drawing of the wires
    others: records of other kinds, each at a character of the drawing
    shown: drawing of the expected signals
    """
    recorder = Recorder()
    run = WaveformWriter(StringIO(), Timebase(150_000_000), MODULES)
    recorder.subscribe(KINDS, run.write)
    wires = drawn(lines)
    edges = [
        (at, Kind.EDGE, channel.name, "level", level)
        for channel in wires.channels
        for at, level in zip(channel.edges.tolist(), channel.levels.tolist(), strict=True)
    ]
    for at, kind, where, what, value in sorted([*edges, *others], key=lambda event: event[0]):
        recorder.emit(at * CHARACTER, kind, where, what, value)
    expected = drawn(shown)
    found = {channel.name: channel for channel in run.bits(expected.length * CHARACTER).channels}
    for channel in expected.channels:
        levels = found[channel.name].at(np.arange(expected.length) * CHARACTER)
        wave = "".join("_-"[level] for level in levels.tolist())
        assert f"{channel.name} {wave}" == f"{channel.name} {drawing(channel.at(np.arange(expected.length)))}"


def drawing(levels: np.ndarray) -> str:
    return "".join("_-"[level] for level in levels.tolist())


def test_bus_state_follows_scl_and_sda():
    check(
        """
        SCL --- _-_-_-_-_-_-_-_- _- _--
        SDA --_ --__--____----__ __ __-
        """,
        [],
        """
        wires.SCL          --- _-_-_-_-_-_-_-_- _- _--
        bus.I2C.busy       __- ---------------- -- --_
        bus.I2C.address    ___ _--------------- __ ___
        bus.I2C.ack        ___ ________________ _- ___
        bus.I2C.nack       ___ ________________ __ ___
        bus.I2C.data       ___ ________________ __ ___
        bus.I2C.byte[7]    ___ _--------------- -- ---
        bus.I2C.byte[6]    ___ ________________ __ ___
        bus.I2C.byte[1]    ___ _--------------- -- ---
        bus.I2C.byte[0]    ___ ________________ __ ___
        """,
    )


def test_bus_state_of_a_write_a_repeated_start_and_a_read_that_is_not_acknowledged():
    """0x53 W ACK, 0x05 ACK, START, 0x53 R ACK, 0x81 NACK, STOP. Address and byte are known at their end."""
    byte = "_-_-_-_-_-_-_-_-_-"
    check(
        f"""
        SCL --- {byte} {byte} _-- {byte} {byte} _--
        SDA --_ --__--____----____ __________--__--__ --_ --__--____------__ --____________---- __-
        """,
        [],
        f"""
        bus.I2C.busy    __- {"-" * 18} {"-" * 18} --- {"-" * 18} {"-" * 18} --_
        bus.I2C.address ___ _{"-" * 15}__ {"_" * 18} ___ _{"-" * 15}__ {"_" * 18} ___
        bus.I2C.data    ___ {"_" * 18} _{"-" * 15}__ ___ {"_" * 18} _{"-" * 15}__ ___
        bus.I2C.ack     ___ {"_" * 17}- {"_" * 17}- ___ {"_" * 17}- {"_" * 18} ___
        bus.I2C.nack    ___ {"_" * 18} {"_" * 18} ___ {"_" * 18} {"_" * 17}- ___
        bus.I2C.read    ___ {"_" * 18} {"_" * 18} ___ {"_" * 16}-- {"-" * 18} ---
        bus.I2C.byte[7] ___ _{"-" * 17} -{"_" * 17} ___ _{"-" * 17} {"-" * 18} ---
        bus.I2C.byte[0] ___ {"_" * 18} _{"-" * 17} --- {"-" * 18} {"-" * 18} ---
        """,
    )


def test_a_register_is_shown_as_a_whole_and_by_field():
    at = "dsp.I2C-A"
    check(
        "SCL ----------",
        [
            (2, Kind.FLAG, at, "I2CSTR.BB", 1),
            (4, Kind.FLAG, at, "I2CSTR.RRDY", 1),
            (4, Kind.FLAG, "dsp.SCI-A", "SCIFFRX.RXFFST", 5),
            (6, Kind.FLAG, at, "I2CSTR.BB", 0),
            (7, Kind.FLAG, "dsp.XINT", "XINT1CR.ENABLE", 1),
        ],
        """
        dsp.I2C_A.I2CSTR.BB            __----____
        dsp.I2C_A.I2CSTR[12]           __----____
        dsp.I2C_A.I2CSTR.RRDY          ____------
        dsp.I2C_A.I2CSTR[3]            ____------
        dsp.I2C_A.I2CSTR[10]           ----------
        dsp.I2C_A.I2CSTR.XSMT          ----------
        dsp.SCI_A.SCIFFRX.RXFFST[2]    ____------
        dsp.SCI_A.SCIFFRX.RXFFST[1]    __________
        dsp.SCI_A.SCIFFRX.RXFFST[0]    ____------
        dsp.SCI_A.SCIFFRX[10]          ____------
        dsp.SCI_A.SCIFFRX[8]           ____------
        """,
    )


def test_interrupts_and_spans_are_bits_even_when_they_are_nested():
    check(
        """
        RX     -----____-
        SPI    --__------
        """,
        [
            (1, Kind.IRQ, "dsp", "I2CINT1A", 1),
            (2, Kind.IRQ, "dsp", "SCIRXINTA", 1),
            (3, Kind.SPAN, "dsp", "model", 1),
            (4, Kind.SPAN, "dsp", "model", 1),
            (5, Kind.SPAN, "dsp", "model", 0),
            (6, Kind.IRQ, "dsp", "SCIRXINTA", 0),
            (7, Kind.SPAN, "dsp", "model", 0),
            (8, Kind.IRQ, "dsp", "I2CINT1A", 0),
        ],
        """
        wires.RX                 -----____-
        wires.TX                 ----------
        wires.MODEL              ----------
        wires.SPI                --__------
        dsp.interrupt.I2CINT1A   _-------__
        dsp.interrupt.SCIRXINTA  __----____
        dsp.span.model           ___----___
        """,
    )


def test_the_last_of_several_changes_in_one_tick_is_shown():
    run = WaveformWriter(StringIO(), Timebase(150_000_000), MODULES)
    recorder = Recorder()
    recorder.subscribe(KINDS, run.write)
    for tick, level in ((0, 0), (30, 1), (30, 0), (60, 1)):
        recorder.emit(tick, Kind.EDGE, "SDA", "level", level)
    sda = run.lines(90).channel("SDA")
    assert (sda.initial, sda.edges.tolist()) == (0, [60])


def test_a_run_ends_at_its_last_change_and_is_at_least_one_tick_long():
    run = WaveformWriter(StringIO(), Timebase(150_000_000), {})
    recorder = Recorder()
    recorder.subscribe(KINDS, run.write)
    assert [run.lines(end).length for end in (0, 1, 2)] == [1, 1, 2]
    recorder.emit(5, Kind.EDGE, "SDA", "level", 0)
    assert [run.lines(end).length for end in (3, 6, 7)] == [6, 6, 7]
    made = run.bits(1)
    assert (made.rate, made.sampled, made.notes, made.exact) == (Timebase(150_000_000).per_second, False, (), True)
    names = [channel.name for channel in made.channels]
    assert [name for name in names if ".byte" in name] == [f"bus.I2C.byte[{bit}]" for bit in range(7, -1, -1)]


# Files, read by other programs -------------------------------------------------------


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with run.psr, run.vcd, run.sr and run.fst: 15 ms with a round of the sensor head and a host frame."""
    folder = tmp_path_factory.mktemp("runs")
    for suffix in ("psr", "vcd", "sr", "fst"):
        recorded_to(folder / f"run.{suffix}", load(TIMING / "imu_hil_published.toml", ["duration=15 ms"]))
    return folder


@pytest.mark.parametrize(
    ("seconds", "mhz"), [("0.02", 100), ("2.68", 100), ("2.69", 50), ("26.8", 10), ("130", 2), ("135", 1), ("9000", 1)]
)
def test_a_session_of_a_long_run_has_a_lower_sample_rate(seconds: str, mhz: int):
    assert rate_for(Fraction(seconds)) == mhz * 10**6


@pytest.mark.parametrize(("sysclkout", "expected"), [(100_000_000, [7, 13]), (150_000_000, [3, 5])])
def test_a_vcd_is_exact_if_a_tick_is_whole_nanoseconds_and_otherwise_rounded_up(
    tmp_path: Path, sysclkout: int, expected: list[int]
):
    rows = [(tick, Kind.EDGE, "SDA", "level", level) for tick, level in ((7, 0), (13, 1))]
    found = formats.read(written(tmp_path / "run.vcd", *rows, end=30, modules={}, sysclk=sysclkout))
    assert (found.rate, found.channels[0].edges.tolist()) == (10**9, expected)


@pytest.mark.skipif(shutil.which("sigrok-cli") is None, reason="sigrok-cli is not installed")
@pytest.mark.parametrize("suffix", [".vcd", ".sr"])
def test_sigrok_decodes_bus_and_line_of_a_recorded_run(runs: Path, suffix: str):
    path, wires = runs / f"run{suffix}", formats.read(runs / "run.psr")
    said = [line.split(": ", 1)[1] for line in sigrok_says(path, "i2c:scl=SCL:sda=SDA").splitlines()]
    bytes_ = [event for event in i2c.events(wires) if event.kind.name == "DATA"]
    assert [line for line in said if line.startswith("Data")] == [
        f"Data {'read' if event.read else 'write'}: {event.value:02X}" for event in bytes_
    ]
    assert len(bytes_) > 20 and said.count("Start") == said.count("Stop") == 3
    said = [line.split(": ", 1)[1] for line in sigrok_says(path, "uart:rx=RX:baudrate=115200").splitlines()]
    frames = uart.events(wires, "RX", uart.Line(115200))
    assert [line for line in said if len(line) == 2] == [f"{frame.value:02X}" for frame in frames]


def test_vcdvcd_finds_the_transitions_of_wires_registers_spans_and_bus_state(runs: Path):
    dump = VCDVCD(str(runs / "run.vcd"))
    wires = formats.read(runs / "run.psr")
    for name in ("SCL", "SDA", "RX"):
        assert [at for at, _ in dump[f"wires.{name}"].tv[1:]] == [
            -(-at * 10**9 // wires.rate) for at in wires.channel(name).edges.tolist()
        ]
    busy = [level for _, level in dump["bus.I2C.busy"].tv]
    assert busy == ["0", "1"] * 3 + ["0"]
    assert dump["dsp.I2C_A.I2CSTR[12]"].tv == dump["dsp.I2C_A.I2CSTR.BB"].tv and len(dump["dsp.I2C_A.I2CSTR.BB"].tv) > 2
    assert [level for _, level in dump["dsp.span.model"].tv][:3] == ["0", "1", "0"]
    assert len(dump["dsp.interrupt.SCIRXINTA"].tv) > 1
    assert all(set(value) <= set("01x") for signal in dump.signals for _, value in dump[signal].tv)


def test_fst_has_registers_as_vectors_and_texts_as_strings(runs: Path):
    found = {one.full_name: one.signal for one in pywellen.Waveform(str(runs / "run.fst")).all_vars()}
    said = [text for _, text in found["bus.I2C.text"]]
    assert said[:7] == ["-", "START", "0x68 W ACK", "0x1D ACK", "repeated START", "0x68 R ACK", "0x00 ACK"]
    assert [text for _, text in found["bus.UART.text"]][:3] == ["-", "0x01", "0x00"]
    assert [value for _, value in found["bus.I2C.byte"]][:5] == [0, 0xD0, 0x1D, 0xD1, 0]
    register, flag = found["dsp.I2C_A.I2CSTR"], found["dsp.I2C_A.I2CSTR.BB"]
    levels = [level for level, _ in groupby(value >> 12 & 1 for _, value in register)]
    assert levels == [value for _, value in flag]
    wires = formats.read(runs / "run.psr")
    assert formats.read(runs / "run.fst").channel("wires.SCL").edges.tolist() == [
        at * 10**12 // wires.rate for at in wires.channel("SCL").edges.tolist()
    ]


def test_without_its_library_fst_names_the_package_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "pylibfst", None)
    with pytest.raises(BadRecording) as caught, recording(tmp_path / "run.fst", MODULES) as (subscribe, _):
        subscribe(Recorder(), Timebase(150_000_000))
        raise AssertionError("nothing may run")
    assert str(caught.value) == ("FST is written by pylibfst, which is not installed: pip install 'periph-sim[fst]'")
    assert list(tmp_path.iterdir()) == []
