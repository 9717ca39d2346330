"""Pulses that everybody follows at once, against the same scene edge by edge: nothing that shows may differ.

A scene in which somebody hears of SDA's edges plays every edge; without that listener the pulses in the
middle of a byte are worked out together. What else is recorded, SCL's edges too, comes out the same in the same order.
"""

from __future__ import annotations

import dataclasses
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.board.scene import Scene
from periph_sim.case.load import load
from periph_sim.case.model import Case
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.f28335.i2c_options import I2cOptions
from periph_sim.lines.i2c_controller import Phase, Transfer
from tests.board.runs import TIMING
from tests.board.small import case

pytestmark = pytest.mark.long

OPTIONS = [
    (f.name, value) for f in dataclasses.fields(I2cOptions) if "values" in f.metadata for value in f.metadata["values"]
]


def told(phase: Phase) -> tuple[Any, ...]:
    """All that a phase knows of what came of it, times included."""
    return (
        phase.acked,
        bytes(phase.got),
        phase.acks,
        phase.start_at,
        phase.answer_from,
        phase.answer_at,
        phase.stretch,
    )


def heard_of(record: Record) -> bool:
    """Of what is compared: everything but SDA and the causes that it would be."""
    return record.kind is not Kind.EDGE or record.where == "SCL"


def outcome(table: Case, seconds: Fraction, heard: bool) -> tuple[dict[str, Any], int]:
    """What a run shows: results, each transfer with its times, every register at the end, records; and its events."""
    records: list[Record] = []

    def subscribe(recorder: Recorder, timebase: Timebase) -> None:
        recorder.subscribe(Kind, records.append, None if heard else {Kind.EDGE: {"SCL"}})

    scene = Scene(table, subscribe)
    transfers: list[Transfer] = []
    if scene.head is not None:
        scene.head.on_transfer.append(transfers.append)
    result = scene.run(seconds)
    shown = dataclasses.asdict(result) | {"wall_s": 0, "events": 0}
    shown["transfers"] = [(t.name, t.stop_at, t.lost, [told(p) for p in t.phases]) for t in transfers]
    for name, dsp in scene.units.items():
        shown[f"{name} cycle"] = dsp.cpu.cycle
        now = dsp.clock.cycle_at(scene.kernel.now)
        for module, socket in dsp.sockets.items():
            registers = socket.chip.MAP
            shown[f"{name} {module}"] = {r.name: socket.peek(now, r.offset) for r in registers if not r.free_running}
    shown["records"] = [r._replace(number=0, cause=0) for r in records if heard_of(r)]
    for name, chip in scene.chips.items():
        shown[f"{name} registers"] = chip.chip.stored, chip.pointer.pointer
    shown["held"] = {name: wire.held_by() for name, wire in scene.wires.items()}
    return shown, result.events


def alike(table: Case, seconds: str) -> tuple[int, int]:
    """Events edge by edge, and with pulses at once."""
    one_by_one, many = outcome(table, Fraction(seconds), heard=True)
    at_once, few = outcome(table, Fraction(seconds), heard=False)
    assert at_once == one_by_one
    return many, few


@pytest.mark.parametrize("name", ["imu_hil", "imu_hil_no_sdir", "wrong_order", "late_model", "responder", "two_dsps"])
def test_every_case(name: str):
    many, few = alike(load(TIMING / f"{name}.toml"), "0.12")
    assert few == many if name == "two_dsps" else few < many  # there a DSP is the controller


@pytest.mark.parametrize(("option", "value"), OPTIONS, ids=[f"{name}={value}" for name, value in OPTIONS])
def test_every_answer_to_an_open_question(option: str, value: object):
    alike(load(TIMING / "imu_hil.toml", [f"unit.dsp.options.i2c.{option}={str(value).lower()}"]), "0.03")


@settings(max_examples=25)
@given(
    replies=st.lists(st.binary(min_size=1, max_size=6), min_size=1, max_size=3),
    write=st.binary(min_size=1, max_size=6),
    rate=st.sampled_from(["10 kHz", "100 kHz", "400 kHz"]),
    hold=st.sampled_from(["0 ns", "20 ns", "300 ns", "900 ns"]),
    fifo=st.booleans(),
    first=st.integers(0, 50_000),
)
def test_any_bytes_rates_and_times(replies, write, rate, hold, fifo, first):
    unit = {
        "firmware": "responder",
        "modules": ["I2C-A", "GPIO"] if first % 2 else ["I2C-A"],
        "settings": {"replies": [reply.hex(" ") for reply in replies], "fifo": fifo},
    }
    requests = [{"address": 0x50, "count": 0, "write": write.hex(" ")}] if write else []
    requests += [{"address": 0x50, "count": len(reply)} for reply in replies] + [{"address": 0x21, "count": 1}]
    head = {"rate": rate, "hold": hold, "first": f"{1_000_000 + first} ns", "rounds": 2, "period": "40 ms"}
    alike(case(unit={"dsp": unit}, controller={**head, "request": requests}), "0.08")


@settings(max_examples=10)
@given(offset=st.integers(0, 4_000), baud=st.sampled_from([115200, 57600, 230400]), cost=st.integers(1, 4000))
def test_host_frames_that_cut_into_the_bytes(offset: int, baud: int, cost: int):
    changes = [f"host.first={5_000 + offset} us", f"host.baud={baud}", f"unit.dsp.settings.model_cost={cost} us"]
    alike(load(TIMING / "imu_hil.toml", changes), "0.05")
