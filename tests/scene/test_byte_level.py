"""The level "byte": a byte in two steps; what of it is as at edges, what is not, and where it is refused.

SCL  _|~|_|~|_ ... _|~|_|~|_|~        edge
                      ^eighth  ^ninth over
RRDY ______________|~~~~~~~~~~~       edge: the noise filter's width behind the fall; byte: looked at from the step on
NACK _________________|~~~~~~~~       edge: behind the ninth rise; byte: seen when that clock is over
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from periph_sim.bus.i2c.transfer import Transfer
from periph_sim.core.records import Kind
from periph_sim.processor.dsp import Dsp
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.result import BYTE_LEVEL, FRAMES, FRAMES_PASSED, SKIPPED
from periph_sim.scene.scene import Scene
from tests.scene import small
from tests.scene.runs import TIMING
from tests.scene.test_adaptive import BUT_EDGES, meddled, run, told
from tests.scene.test_adaptive_sci import alone, joined

SILENT = {"dsp": Firmware("silent", lambda dsp, settings: None, None)}

FIGURES_AS_EDGE = (
    "imu_hil",
    "imu_hil_400k",
    "imu_hil_lost_byte",
    "imu_hil_no_sdir",
    "imu_moving",
    "late_model",
    "responder",
    "wrong_order",
)


@pytest.mark.parametrize("name", FIGURES_AS_EDGE)
def test_figures_of_shipped_cases_are_those_of_edges(name: str):
    edge, byte = (run(load(TIMING / f"{name}.toml"), level, (), "0.05")[0] for level in ("edge", "byte"))
    edge.counts[SKIPPED] = byte.counts[SKIPPED]
    assert told(byte) == told(edge)
    assert byte.counts[BYTE_LEVEL] == byte.wire_bytes > 40
    assert byte.events < edge.events / 4


def test_waits_end_within_the_noise_filter_and_one_pass_of_where_they_end_at_edges():
    case = load(TIMING / "responder.toml")
    edge, byte = (run(case, level, BUT_EDGES, "0.1")[1] for level in ("edge", "byte"))
    writes = [[r.tick for r in of if r.kind is Kind.ACCESS and r.what == "W I2C-A.I2CDXR"] for of in (edge, byte)]
    cycle = Scene(case).timebase.per_second // 150_000_000
    errors = [abs(b - a) // cycle for a, b in zip(*writes, strict=True)]
    assert len(errors) == 340 and 0 < max(errors) <= 15 + 10  # the filter at IPSC = 14, and a pass of the wait


def clocked(dsp: Dsp):
    """The I2C module, its clock on."""
    dsp.eallow()
    dsp.module("SYS").PCLKCR0.I2CAENCLK = 1
    dsp.edis()
    return dsp.module("I2C-A")


def nack_seen(level: str) -> int:
    """The cycle at which firmware finds NACK set, who polls for it."""
    seen: list[int] = []

    def firmware(dsp: Dsp, settings: object) -> None:
        i2c = clocked(dsp)
        i2c.I2CPSC.all = 14
        i2c.I2COAR.all = 0x50
        i2c.I2CMDR.all = 0x4020
        i2c.I2CDXR.all = 0x5A
        dsp.spin(lambda: i2c.I2CSTR.NACK == 1)
        seen.append(dsp.cpu.cycle)

    table = {"rate": "100 kHz", "first": "1 ms", "rounds": 1, "request": [{"address": 0x50, "count": 1}]}
    made = small.case(
        unit={"dsp": {"firmware": "polls", "modules": ["I2C-A"]}}, controller=table, fidelity=level, duration="3 ms"
    )
    Scene(made, programs={"dsp": Firmware("polls", firmware, None)}).run()
    return seen[0]


def test_a_nack_is_seen_when_its_clock_is_over_and_not_with_its_rise():
    high = 750  # cycles of SCL's high time, half of 10 us
    late = nack_seen("byte") - nack_seen("edge")
    assert high - 15 - 10 <= late <= high + 10


def test_what_meddles_in_the_middle_of_a_byte_is_met_differently_and_the_same_each_time():
    other = 0
    for seed in range(12):
        byte, again, edge = meddled(seed, "byte"), meddled(seed, "byte"), meddled(seed, "edge")
        assert byte[1:] == again[1:] and told(byte[0]) == told(again[0])
        other += byte[2] != edge[2]
    assert other > 3


@pytest.mark.parametrize("point", ["before_ack", "after_fall9"])
def test_a_byte_for_which_scl_is_held_goes_by_edges_from_there_on(point: str):
    """A receiver without room holds SCL at its second byte, until the first is read."""

    def firmware(dsp: Dsp, settings: object) -> None:
        i2c = clocked(dsp)
        i2c.I2CPSC.all = 14
        i2c.I2COAR.all = 0x50
        i2c.I2CMDR.all = 0x4020
        for _ in range(4):
            dsp.compute(Fraction(300, 10**6))
            got.append(i2c.I2CDRR.all)

    heard = {}
    unit = {"firmware": "slow", "modules": ["I2C-A"]}
    for level in ("edge", "byte"):
        got: list[int] = []
        table = {"first": "100 us", "rounds": 1, "request": [{"address": 0x50, "count": 0, "write": "01 02 03 04"}]}
        made = small.case(
            unit={"dsp": {**unit, "options": {"i2c": {"rsfull_stretch_point": point}}}},
            controller=table,
            fidelity=level,
            duration="3 ms",
        )
        scene = Scene(made, programs={"dsp": Firmware("slow", firmware, None)})
        transfers: list[Transfer] = []
        scene.on_transfer(transfers.append)
        result = scene.run()
        (transfer,) = transfers
        phases = [(phase.data, phase.acks, phase.stretch) for phase in transfer.phases]
        heard[level] = got, transfer.stop_at, phases, result.wire_bytes
    assert heard["byte"] == heard["edge"] and heard["edge"][0] == [1, 2, 3, 4]
    assert heard["edge"][2][0][2] > 0  # SCL was held


@pytest.mark.parametrize("fidelity", ["byte", "adaptive"])
def test_the_share_of_a_run_that_ends_within_a_transfer_is_of_the_bytes_that_are_over(fidelity: str):
    scene = Scene(load(TIMING / "responder.toml", [f"fidelity={fidelity}"]))
    result = scene.run(Fraction(7, 1000))
    assert 0 < scene.bus.wire_bytes < result.wire_bytes == result.counts[BYTE_LEVEL] <= scene.bus.passed
    assert result.share_above_edges.startswith("100.0 % of the I2C bytes")


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("imu_chips", "accelerometer and gyroscope and magnetometer may pull SCL and SDA edge by edge"),
        ("imu_hil_broken_line", "fault 0 (spike) may pull RX edge by edge"),
        ("imu_hil_spikes", "fault 0 (spike) and fault 1 (spike) may pull SCL and SDA edge by edge"),
    ],
)
def test_a_bus_that_is_driven_edge_by_edge_is_refused(name: str, why: str):
    case = load(TIMING / f"{name}.toml", ["fidelity=byte"])
    with pytest.raises(BadCase) as refused:
        Scene(case)
    assert f'"byte" cannot be: {why}; use "edge", or "adaptive" with the same records' in str(refused.value)


@pytest.mark.parametrize("name", ["two_dsps", "eeprom_log"])
def test_bytes_of_a_unit_that_is_the_master_pass_as_at_adaptive(name: str):
    case = load(TIMING / f"{name}.toml")
    (edge, records), (byte, same) = (run(case, level, BUT_EDGES, "0.05") for level in ("edge", "byte"))
    assert told(byte) == told(edge) and same == records
    assert byte.counts[BYTE_LEVEL] >= 0.99 * byte.wire_bytes > 50


@pytest.mark.parametrize("name", ["uart_logger"])
def test_sci_frames_pass_as_at_adaptive(name: str):
    case = load(TIMING / f"{name}.toml")
    (edge, records), (byte, same) = (run(case, level, BUT_EDGES, "0.05") for level in ("edge", "byte"))
    assert told(byte) == told(edge) and same == records
    assert byte.counts[FRAMES_PASSED] == byte.counts[FRAMES] > 20


@pytest.mark.parametrize("scene", [alone, joined])
def test_other_rates_formats_breaks_and_autobaud_go_edge_by_edge(scene: Any):
    edge, byte = (scene(3, level, BUT_EDGES) for level in ("edge", "byte"))
    assert byte[1:] == edge[1:] and told(byte[0]) == told(edge[0])
    assert 0 < byte[0].counts[FRAMES_PASSED] < byte[0].counts[FRAMES]


def test_a_scene_without_a_bus_is_refused():
    with pytest.raises(BadCase, match="there is neither an I2C bus nor an SCI"):
        Scene(small.case(unit={"dsp": {"firmware": "silent", "modules": ["GPIO"]}}, fidelity="byte"), programs=SILENT)


def test_a_pair_of_which_several_have_the_line_is_refused():
    unit = {"dsp": {"firmware": "silent", "modules": ["SCI-A", "GPIO"]}}
    case = small.case(unit=unit, transceiver=[{"on": "dsp.SCI-A", "de": "dsp.GPIO34"}], fidelity="byte")
    with pytest.raises(BadCase, match=r"transceiver of dsp\.SCI-A may pull RX edge by edge"):
        Scene(case, programs=SILENT)


def test_recorded_edges_of_a_line_are_refused():
    with pytest.raises(BadCase, match="edges of RX are recorded"):
        Scene(
            load(TIMING / "uart_logger.toml", ["fidelity=byte"]),
            lambda recorder, _: recorder.subscribe([Kind.EDGE], lambda record: None, {Kind.EDGE: ["RX"]}),
        )


def test_recorded_edges_are_refused():
    case = load(TIMING / "responder.toml", ["fidelity=byte"])
    with pytest.raises(BadCase) as refused:
        Scene(case, lambda recorder, _: recorder.subscribe([Kind.EDGE], lambda record: None))
    told_why = "edges of SCL and SDA are recorded (--record, worst and others do), and bytes have none"
    assert f'{told_why}; use "edge", or "adaptive" with the same records' in str(refused.value)


def test_a_budget_on_edges_is_refused_by_its_name():
    table = {"first": "100 us", "rounds": 1, "request": [{"address": 0x50, "count": 1}]}
    budget = [{"name": "flags", "measure": "nacked rounds", "max": 1}]
    budget.append({"name": "clock", "measure": "period of edge SCL fall", "max": "20 ms"})
    unit = {"dsp": {"firmware": "silent", "modules": ["I2C-A"]}}
    for level in ("edge", "adaptive", "byte"):
        case = small.case(unit=unit, controller=table, budget=budget, fidelity=level)
        if level != "byte":
            assert Scene(case, programs=SILENT).run().budgets[1].verdict == "pass"
            continue
        with pytest.raises(BadCase) as refused:
            Scene(case, programs=SILENT)
        what = "budget 'clock' looks at edges of SCL and SDA, and bytes have none"
        assert f'"byte" cannot be: {what}; use "edge", or "adaptive"' in str(refused.value)
