"""Skipped bits of I2C bytes and skipped polls of images change no record and no result of a run.

                   START  address + R      A    data              A
    edge by edge    ~|_|~|_|~|_..._|~|_|~|_|~|_|~|_..._|~|_|~|_|~    an event each
    bits skipped    ~|________________|~|_|~|______________|~|_|~|_|~    seven bits in one step

Firmware, hosts and faults may read the lines or change the module in the middle of a byte at any time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, replace
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import pytest

from periph_sim import Case, Dsp, Firmware, Result, Scene, load
from periph_sim.core.records import RECORDED, Kind, Record
from periph_sim.records.races import races
from periph_sim.records.run import Run as RecordedRun
from periph_sim.traces.formats.record_table import Columns
from tests.profiles import explores
from tests.scene import small
from tests.scene.runs import TIMING, recorded

BUT_EDGES = tuple(kind for kind in Kind if kind not in (Kind.EDGE, Kind.HOLD))
Disable = tuple[str, ...]
Programs = dict[str, Firmware]
BY_EDGES: Disable = ("bits",)
SKIPPING: Disable = ()
# Cases in which an agent is the controller and no fault can pull a line.
WHOLLY = ("imu_chips", "imu_hil", "imu_hil_400k", "imu_hil_lost_byte", "imu_moving", "real_chips", "responder")


def run(case: Case, disable: Disable, kinds: tuple[Kind, ...], seconds: str, programs: Programs | None = None):
    """Return (result, records) of a case."""
    scene, records = recorded(case.model_copy(update={"disable": disable}), kinds, programs)
    return scene.run(Fraction(seconds)), records


def figures(result: Result) -> dict[str, object]:
    """Return the fields of a result that describe the case, without those that describe the work of the simulator."""
    return asdict(replace(result, wall_s=0.0, events=0, bytes_skipped=0))


@pytest.mark.parametrize("name", WHOLLY)
def test_bits_of_every_byte_are_skipped_where_nothing_acts_in_mid_byte(name: str):
    by_edges, skipping = (
        run(load(TIMING / f"{name}.toml"), disable, (), "0.05")[0] for disable in (BY_EDGES, SKIPPING)
    )
    assert skipping.bytes_skipped == skipping.wire_bytes > 40
    assert skipping.events < by_edges.events / 2
    assert by_edges.bytes_skipped == 0 and figures(skipping) == figures(by_edges)


@pytest.mark.parametrize("wire", ["SCL", "SDA"])
def test_no_bits_are_skipped_if_edges_of_the_bus_are_recorded(wire: str):
    scene, records = recorded(load(TIMING / "responder.toml"), [Kind.EDGE], subjects={Kind.EDGE: (wire,)})
    result = scene.run(Fraction("0.05"))
    assert result.bytes_skipped == 0 and result.wire_bytes > 40
    assert {record.where for record in records} == {wire} and len(records) > 300


@pytest.mark.parametrize("name", ["imu_hil_spikes", "imu_hil_stuck_sda", "imu_hil_glitches"])
def test_no_bits_are_skipped_with_a_fault_that_may_pull_a_line_at_any_time(name: str):
    skipping = run(load(TIMING / f"{name}.toml"), SKIPPING, (), "0.05")[0]
    assert skipping.bytes_skipped == 0 and skipping.wire_bytes > 40


# Actions in the middle of a byte -------------------------------------------------------


class MidByteFirmware:
    """Slave firmware that, at times drawn from a seed, reads or changes what depends on the middle of a byte."""

    def __init__(self, seed: int) -> None:
        self.random = Random(seed)
        self.seen: list[tuple[str, int, int]] = []  # (action, cycle, value read)

    def __call__(self, dsp: Dsp) -> None:
        i2c, gpio, system = dsp.module("I2C-A"), dsp.module("GPIO"), dsp.module("SYS")
        self.start(dsp)
        actions = {
            "look at the pads": lambda: gpio.GPBDAT.all >> 0 & 3,
            "look at flags": lambda: i2c.I2CSTR.all,
            "write a byte": lambda: self.put(i2c.I2CDXR, self.random.randrange(256)),
            "reset the module": lambda: self.off_and_on(i2c),
            "refuse a byte": lambda: self.put(i2c.I2CMDR, 0x4020 | 0x8000),
            "bits of a byte": lambda: self.put(i2c.I2CMDR, 0x4020 | self.random.choice((0, 7, 3))),
            "take the pins": lambda: self.pins(dsp, gpio),
            "stop the clock": lambda: self.clock(dsp, system),
            "change the clock": lambda: self.pll(dsp, system),
            "own address": lambda: self.put(i2c.I2COAR, self.random.choice((0x50, 0x51))),
        }
        while True:
            dsp.compute(self.random.choice((3, 40, 700, 5_000, 20_000)) + self.random.randrange(1_000))
            what = self.random.choice(list(actions))
            seen = actions[what]()
            self.seen.append((what, dsp.cpu.cycle, int(seen or 0)))

    def start(self, dsp: Dsp) -> None:
        i2c, gpio = dsp.module("I2C-A"), dsp.module("GPIO")
        dsp.eallow()
        dsp.module("SYS").PCLKCR0.I2CAENCLK = 1
        gpio.GPBPUD.all = 0
        gpio.GPBQSEL1.all = 0xF
        gpio.GPBMUX1.all = 5
        dsp.edis()
        i2c.I2CPSC.all = 14
        i2c.I2COAR.all = 0x50
        i2c.I2CMDR.all = 0x4020

    @staticmethod
    def put(register, value: int) -> None:
        register.all = value

    @staticmethod
    def off_and_on(i2c) -> None:
        i2c.I2CMDR.IRS = 0
        i2c.I2CMDR.IRS = 1

    def pins(self, dsp: Dsp, gpio) -> None:
        dsp.eallow()
        gpio.GPBMUX1.all = 0
        dsp.compute(self.random.randrange(3_000))
        gpio.GPBMUX1.all = 5
        dsp.edis()

    def clock(self, dsp: Dsp, system) -> None:
        dsp.eallow()
        system.PCLKCR0.I2CAENCLK = 0
        dsp.compute(self.random.randrange(3_000))
        system.PCLKCR0.I2CAENCLK = 1
        dsp.edis()

    def pll(self, dsp: Dsp, system) -> None:
        dsp.eallow()
        system.PLLSTS.DIVSEL = self.random.choice((1, 2))
        dsp.edis()


def run_in_mid_byte(seed: int, disable: Disable):
    request = [{"address": 0x50, "count": 6}, {"address": 0x50, "pointer": 3, "count": 2}]
    table = {"rate": "100 kHz", "first": "1 ms", "period": "2 ms", "request": request, "on_nack": "give up"}
    firmware = MidByteFirmware(seed)
    made = small.case(unit={"dsp": small.unit("I2C-A", "GPIO")}, controller=table)
    return *run(made, disable, BUT_EDGES, "0.02", small.given(dsp=firmware)), firmware.seen


def same_by_edges(experiment: Callable[[int, Disable], tuple[Any, ...]], seed: int) -> Result:
    """Return the result with skipped bits, after a check that all else is equal to the run edge by edge."""
    by_edges, skipping = experiment(seed, BY_EDGES), experiment(seed, SKIPPING)
    assert skipping[1:] == by_edges[1:]
    assert figures(skipping[0]) == figures(by_edges[0])
    return skipping[0]


SEEDS = range(200) if explores() else [*range(26), 95]


@pytest.mark.parametrize("seed", SEEDS)
def test_actions_in_the_middle_of_a_byte_give_the_same_with_skipped_bits(seed: int):
    same_by_edges(run_in_mid_byte, seed)


class OwnRate(MidByteFirmware):
    """The same firmware with another module clock."""

    def __init__(self, seed: int, prescaler: int) -> None:
        super().__init__(seed)
        self.prescaler = prescaler

    def start(self, dsp: Dsp) -> None:
        super().start(dsp)
        i2c = dsp.module("I2C-A")
        i2c.I2CMDR.IRS = 0
        i2c.I2CPSC.all = self.prescaler
        i2c.I2CMDR.IRS = 1


def near_the_filter(seed: int, disable: Disable):
    """Run the firmware on a bus on which a time of SCL or SDA is close to the noise filter's, or to a module clock."""
    random = Random(f"near the filter {seed}")
    prescaler, width = random.choice((0, 1, 5, 14, 29)), random.choice((1, 1, 2, 5))
    module_clock = 20 * (prescaler + 1)  # ticks of 1/3 ns
    filtered = width * module_clock
    short = random.choice(("high", "low behind hold", "low behind filter", "hold", "none"))

    def length(name: str, usual: int) -> int:
        if name != short:
            return usual
        return max(60, random.choice((filtered, module_clock)) + random.randrange(-100, 60))

    def ample() -> int:
        return filtered + random.randrange(2 * module_clock, 6 * module_clock + 400)

    high, hold = length("high", ample()), length("hold", module_clock + random.randrange(60, 400))
    low = max(hold + length("low behind hold", ample()), filtered + length("low behind filter", ample()))
    times = {name: f"{ticks / 3:.3f} ns" for name, ticks in (("high", high), ("hold", hold), ("low", low))}
    request = [{"address": 0x50, "count": 6}, {"address": 0x50, "pointer": 3, "count": 2}]
    table = {**times, "first": "300 us", "period": "700 us", "request": request, "on_nack": "give up"}
    options = {"noise_filter_cycles": width, "unequal_arrival": random.choice(("in_order", "one_sample"))}
    unit = small.unit("I2C-A", "GPIO", ppm=random.choice((0, 37, -61)), options={"i2c": options})
    firmware = OwnRate(seed, prescaler)
    made = small.case(unit={"dsp": unit}, controller=table)
    return *run(made, disable, BUT_EDGES, "0.006", small.given(dsp=firmware)), firmware.seen


@pytest.mark.parametrize("seed", range(200) if explores() else [*range(22), 39])
def test_times_close_to_the_noise_filter_give_the_same_with_skipped_bits(seed: int):
    same_by_edges(near_the_filter, seed)


def beside_devices(seed: int, disable: Disable):
    """Run the firmware beside an EEPROM and a register map, which stretch, refuse and lose power by a seed."""
    random = Random(seed)
    off = random.randrange(1_000, 15_000) // 2_000 * 2_000 + 1_700 + random.randrange(600)  # late in a round
    faults = [
        {"kind": "off", "after": f"{off} us", "until": f"{off + random.randrange(1, 900)} us"},
        {"kind": "nack", "share": "10 %"},
        {"kind": "flip", "share": "20 %"},
    ]
    stretch = {"length": "1 us to 30 us", "share": random.choice(["0.1 %", "20 %"])}
    register = [{"name": f"DATA{n}", "at": n, "reset": 0x25} for n in range(8)]
    devices = {
        "eeprom": {"model": "24lc64", "address": 0x52, "fault": faults, "stretch": stretch},
        "map": {"model": "registers", "address": 0x48, "register": register, "fault": faults[:1]},
    }
    requests = [
        {"address": 0x50, "count": 3},
        {"address": 0x52, "write": "00 10 55", "count": 0},
        {"address": 0x52, "write": "00 10", "count": 2},
        {"address": 0x48, "pointer": 0, "count": 8},
    ]
    table = {"rate": random.choice(["100 kHz", "400 kHz"]), "first": "1 ms", "period": "2 ms", "request": requests}
    firmware = MidByteFirmware(seed)
    made = small.case(unit={"dsp": small.unit("I2C-A", "GPIO")}, controller=table, device=devices, seed=seed)
    return *run(made, disable, BUT_EDGES, "0.02", small.given(dsp=firmware)), firmware.seen


@pytest.mark.parametrize("seed", range(200) if explores() else [*range(15), 134])
def test_devices_that_stretch_refuse_and_lose_power_give_the_same_with_skipped_bits(seed: int):
    assert same_by_edges(beside_devices, seed).bytes_skipped > 0


def test_actions_occur_in_the_middle_of_skipped_bytes(monkeypatch: pytest.MonkeyPatch):
    """Without such actions the tests above would prove nothing."""
    from periph_sim.core.kernel import Kernel

    went_back = []
    replay = Kernel.replay
    if not isinstance(replay, type(lambda: 0)):
        pytest.skip("methods of the compiled kernel cannot be replaced")
    monkeypatch.setattr(Kernel, "replay", lambda self, *given: (went_back.append(self.now), replay(self, *given))[1])
    results = [run_in_mid_byte(seed, SKIPPING)[0] for seed in range(5)]
    assert len(went_back) > 20
    assert sum(result.bytes_skipped for result in results) > 20


HOLDS_IN_MID_BYTE = """
class Device:
    def __init__(self, bus):
        self.bus, self.count = bus, 0

    def on_write(self, byte):
        self.bus.after("33 us", lambda: self.bus.stretch("47 us"))

    def on_read(self):
        self.count += 1
        self.bus.after("41 us", lambda: self.bus.stretch("29 us"))
        return self.count
"""


def test_a_device_that_holds_scl_in_the_middle_of_a_byte_gives_the_same_with_skipped_bits(tmp_path: Path):
    (tmp_path / "holds.py").write_text(HOLDS_IN_MID_BYTE, "utf-8")
    made = small.case(
        device={"it": {"model": str(tmp_path / "holds.py"), "address": 0x51}},
        controller={"rate": "100 kHz", "first": "1 ms", "request": [{"address": 0x51, "pointer": 3, "count": 6}]},
        budget=[{"name": "stretch", "measure": "stretch", "max": "100 us"}],
    )
    by_edges, skipping = (run(made, disable, BUT_EDGES, "0.01") for disable in (BY_EDGES, SKIPPING))
    assert skipping[1] == by_edges[1] and figures(skipping[0]) == figures(by_edges[0])
    (stretch,) = skipping[0].budgets
    assert stretch.worst > 30


def test_a_run_that_ends_in_the_middle_of_a_byte_leaves_the_lines_as_they_are(tmp_path: Path):
    case = load(TIMING / "responder.toml")
    for ticks in range(0, 400, 7):
        levels = []
        for disable in (BY_EDGES, SKIPPING):
            scene = Scene(case.model_copy(update={"disable": disable}))
            scene.kernel.run_until(scene.start + scene.timebase.ticks(Fraction(1, 1000) + Fraction(ticks, 10**6)))
            levels.append([(wire.level, wire.held_by()) for wire in (scene.wires["SCL"], scene.wires["SDA"])])
        assert levels[0] == levels[1], ticks


TO_ONE_ROUND = ("duration=12.3 ms", "host.first=5 ms")
RECORDED_BUT_EDGES = tuple(kind for kind in RECORDED if kind not in (Kind.EDGE, Kind.HOLD))


def image_run(*changes: str) -> tuple[Result, list[Record]]:
    scene, records = recorded(load(TIMING / "imu_hil_image.toml", [*TO_ONE_ROUND, *changes]), RECORDED_BUT_EDGES)
    return scene.run(), records


def test_skipped_bits_give_the_same_records_and_figures():
    result, records = image_run()
    by_edges, expected = image_run('disable=["bits"]')
    assert len(records) > 800
    without_numbers = [[record._replace(number=0, cause=0) for record in some] for some in (records, expected)]
    assert without_numbers[0] == without_numbers[1]
    assert result.budgets == by_edges.budgets
    assert result.events < by_edges.events / 2


def recorded_run(*changes: str) -> RecordedRun:
    """Return the run as a recording of it has it, with the clocks of its units."""
    columns = Columns()
    case = load(TIMING / "imu_hil_image.toml", [*TO_ONE_ROUND, *changes])
    scene = Scene(case, lambda recorder, _: recorder.subscribe(RECORDED, columns.add))
    scene.run()
    per_second = Fraction(scene.timebase.per_second)
    return RecordedRun(columns.table(per_second, scene.kernel.now, case.recorded_modules, scene.clocks()))


def test_skipped_polls_are_restored_at_their_times():
    """The crystal is off by 30 ppm, so no cycle is a whole number of ticks. The wait for XRDY or SCD has two polls."""
    skipped, made = (
        races(recorded_run("duration=9.3 ms", f"unit.dsp.skip_polls={skip}")) for skip in ("true", "false")
    )
    closest = [
        {
            place.place: (place.register, place.before and place.before.cycles, place.after and place.after.cycles)
            for place in some.places
        }
        for some in (skipped, made)
    ]
    assert closest[0] == closest[1] and len(closest[0]) >= 6
    near = [{place.place: place.histogram[:2] for place in some.places} for some in (skipped, made)]
    assert near[0] == near[1]  # within 10 cycles of a change
    assert sum(place.polls for place in skipped.places) > 10 and not any(place.unplaced for place in skipped.places)
