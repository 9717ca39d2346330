"""Bits of bytes that an F28335 clocks as the master are skipped, too, and change no record and no result.

    head (master) --SCL, SDA--> unit, EEPROM: each on a clock of its own

Firmware of both units commands transfers and changes its module at any time; both may want to be master at once.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest

from periph_sim import Dsp, load
from periph_sim.core.records import Record
from tests.profiles import explores
from tests.scene import small
from tests.scene.runs import TIMING, recorded
from tests.scene.test_bit_skip import BUT_EDGES, BY_EDGES, SKIPPING, Disable, figures, run, same_by_edges


class MidByteMaster:
    """Firmware that commands transfers as master and, at times drawn from a seed, acts in the middle of a byte."""

    def __init__(self, seed: str, pads: bool, own: int, master: float) -> None:
        self.random = Random(seed)
        self.pads, self.own, self.master = pads, own, master
        self.seen: list[tuple[str, int, int]] = []  # (action, cycle, value read)

    def __call__(self, dsp: Dsp) -> None:
        i2c, draw = dsp.module("I2C-A"), self.random
        self.start(dsp)
        actions = {
            "look at flags": lambda: i2c.I2CSTR.all,
            "write a byte": lambda: self.put(i2c.I2CDXR, draw.randrange(256)),
            "read a byte": lambda: i2c.I2CDRR.all,
            "clear flags": lambda: self.put(i2c.I2CSTR, 0x003F),
            "reset the module": lambda: self.off_and_on(dsp),
            "change SCL": lambda: self.put(draw.choice((i2c.I2CCLKL, i2c.I2CCLKH)), draw.choice((30, 45, 60))),
            "stop the clock": lambda: self.gate(dsp),
            "stop": lambda: self.put(i2c.I2CMDR, 0x4C20),
        }
        if self.pads:
            actions["look at the pads"] = lambda: dsp.module("GPIO").GPBDAT.all & 3
        while True:
            dsp.compute(draw.choice((40, 700, 5_000, 30_000)) + draw.randrange(1_000))
            if draw.random() < self.master:
                self.seen.append(("transfer", dsp.cpu.cycle, self.command(dsp)))
                continue
            what = draw.choice(list(actions))
            seen = actions[what]()
            self.seen.append((what, dsp.cpu.cycle, int(seen or 0)))

    def command(self, dsp: Dsp) -> int:
        """Command a transfer to or from a drawn address, and return the bytes read with I2CSTR."""
        i2c, draw = dsp.module("I2C-A"), self.random
        address, count = draw.choice((0x50, 0x51, 0x51, 0x52, 0x31)), draw.randrange(1, 6)
        first, mdr = draw.randrange(256), draw.choice((0x6E20, 0x6E20, 0x6C20, 0x6C20, 0x6620, 0x6EA0))
        small.command(i2c, address, count, mdr, first)
        got = 0
        for _ in range(draw.randrange(8)):
            dsp.compute(13_500 + draw.randrange(3_000))
            if mdr & 0x0200:
                i2c.I2CDXR.all = draw.choice((0, 255, draw.randrange(256)))
            else:
                got = got << 8 | i2c.I2CDRR.all
        if i2c.I2CSTR.NACK:
            i2c.I2CMDR.all = 0x4C20  # STP
            i2c.I2CSTR.all = 0x0002
        return got << 16 | i2c.I2CSTR.all

    def start(self, dsp: Dsp) -> None:
        i2c = dsp.module("I2C-A")
        dsp.eallow()
        dsp.module("SYS").PCLKCR0.I2CAENCLK = 1
        if self.pads:
            gpio = dsp.module("GPIO")
            gpio.GPBPUD.all = 0
            gpio.GPBQSEL1.all = 0xF
            gpio.GPBMUX1.all = 5
        dsp.edis()
        self.settings(dsp)
        i2c.I2CMDR.all = 0x4020

    def settings(self, dsp: Dsp) -> None:
        i2c = dsp.module("I2C-A")
        i2c.I2CPSC.all = 14
        i2c.I2CCLKL.all = i2c.I2CCLKH.all = 45
        i2c.I2COAR.all = self.own

    @staticmethod
    def put(register, value: int) -> None:
        register.all = value

    def off_and_on(self, dsp: Dsp) -> None:
        dsp.module("I2C-A").I2CMDR.all = 0
        self.settings(dsp)
        dsp.module("I2C-A").I2CMDR.all = 0x4020

    def gate(self, dsp: Dsp) -> None:
        system = dsp.module("SYS")
        dsp.eallow()
        system.PCLKCR0.I2CAENCLK = 0
        dsp.compute(self.random.randrange(3_000))
        system.PCLKCR0.I2CAENCLK = 1
        dsp.edis()
        self.off_and_on(dsp)


def run_in_mid_byte(seed: int, disable: Disable):
    random = Random(seed)
    units, masters = {}, {}
    for name, own, master in (("head", 0x50, 0.7), ("imu", 0x51, random.choice((0.0, 0.2)))):
        pads = random.random() < 0.5
        modules = ["I2C-A", "GPIO"] if pads else ["I2C-A"]
        units[name] = small.unit(*modules, ppm=random.choice((0, 0, 50, -50, 20)))
        masters[name] = MidByteMaster(f"{name} {seed}", pads, own, master)
    eeprom = {"model": "24lc64", "address": 0x52, "write_time": "100 us to 2 ms"}
    made = small.case(unit=units, device={"eeprom": eeprom}, seed=seed)
    return *run(made, disable, BUT_EDGES, "0.03", small.given(**masters)), [one.seen for one in masters.values()]


@pytest.mark.parametrize("seed", range(200) if explores() else range(20))
def test_masters_that_act_in_mid_byte_give_the_same_with_skipped_bits(seed: int):
    same_by_edges(run_in_mid_byte, seed)


def test_bits_of_the_masters_above_are_skipped():
    """Without skipped bits the test above would prove nothing."""
    results = [run_in_mid_byte(seed, SKIPPING)[0] for seed in range(10)]
    passed, bytes_ = (
        sum(result.bytes_skipped for result in results),
        sum(result.wire_bytes for result in results),
    )
    assert bytes_ > 150 and passed > bytes_ // 2


@pytest.mark.parametrize("name", ["two_dsps", "eeprom_log", "eeprom_overrun"])
def test_bits_of_shipped_masters_are_skipped(name: str):
    by_edges, skipping = (run(load(TIMING / f"{name}.toml"), disable, (), "0.1")[0] for disable in (BY_EDGES, SKIPPING))
    assert skipping.bytes_skipped >= 0.99 * skipping.wire_bytes > 100
    assert skipping.events < 0.7 * by_edges.events
    assert figures(skipping) == figures(by_edges)


def test_a_line_that_stays_low_is_reported_at_the_same_tick():
    """SCL is held low after a skipped byte, whose edges the monitor of stuck lines did not receive."""

    def firmware(dsp: Dsp) -> None:
        master = MidByteMaster("", False, 0x50, 0)
        master.start(dsp)
        i2c = dsp.module("I2C-A")
        small.command(i2c, 0x51, 3, first=0xA0)
        dsp.compute(Fraction(12, 1000))  # the second byte is never written: SCL is held low

    def silent(dsp: Dsp) -> None:
        MidByteMaster("", False, 0x51, 0).start(dsp)

    came: list[list[Record]] = []
    for disable in (BY_EDGES, SKIPPING):
        case = small.case(
            unit={"head": small.unit("I2C-A"), "imu": small.unit("I2C-A")},
            rounds={"period": "10 ms", "stuck_after": "2 ms", "request": [{"address": 0x51, "count": 1}]},
            budget=[{"name": "stuck", "measure": "stuck", "max": 9}],
            disable=disable,
        )
        scene, records = recorded(case, BUT_EDGES, small.given(head=firmware, imu=silent))
        scene.run()
        came.append(records)
    assert came[0] == came[1]
    assert [record.what for record in came[0] if record.what == "stuck"] == ["stuck"]


def test_edges_are_received_after_a_reset_as_scl_is_released_for_the_eighth_bit():
    """The reset comes between output and pin: the bits were skipped, and SCL never rises for the one that is due."""

    def resetting(delay: int, disable: Disable) -> list[Record]:
        def firmware(dsp: Dsp) -> None:
            master = MidByteMaster("", True, 0x50, 0)
            master.start(dsp)
            i2c = dsp.module("I2C-A")
            for wait in (delay, 40_000):
                master.off_and_on(dsp)
                dsp.compute(Fraction(100, 10**6))
                small.command(i2c, 0x51, 1, first=0xA5)
                dsp.compute(wait)
                i2c.I2CMDR.all = 0

        options = {"i2c": {"stt_while_busy": "always_repeated_start"}}  # a reset leaves BB set
        unit = small.unit("I2C-A", "GPIO", options=options)
        case = small.case(unit={"dsp": unit}, disable=disable, duration="1 ms")
        scene, records = recorded(case, programs=small.given(dsp=firmware))
        scene.run()
        return records

    def rises(records: list[Record]) -> list[int]:
        return [record.tick for record in records if record.where == "SCL" and record.value]

    whole = resetting(40_000, BY_EDGES)
    command = next(r.tick for r in whole if r.what == "W I2C-A.I2CMDR" and r.value == 0x6E20)
    eighth = (rises(whole)[7] - command) // 20  # ticks in a cycle
    lost = 0
    for delay in range(eighth - 16, eighth + 8):
        by_edges, skipping = resetting(delay, BY_EDGES), resetting(delay, SKIPPING)
        assert skipping == by_edges, delay
        lost += rises(by_edges)[7] != rises(whole)[7]  # the reset releases SCL
        assert len(rises(by_edges)) > 16
    assert 0 < lost < 24


def test_bits_that_a_slave_s_noise_filter_swallows_are_not_skipped_after_bits_that_pass_it():
    """The low time of SCL in the master's next byte is shorter than the filter, and its high time is longer."""

    def master(dsp: Dsp) -> None:
        MidByteMaster("", False, 0x50, 0).start(dsp)
        i2c = dsp.module("I2C-A")
        i2c.I2CMDR.all = 0
        i2c.I2CPSC.all = 0
        i2c.I2CCLKL.all, i2c.I2CCLKH.all = 37, 20
        i2c.I2CMDR.all = 0x4020
        small.command(i2c, 0x51, 2, first=0xA5)
        dsp.compute(5_000)
        i2c.I2CCLKL.all, i2c.I2CCLKH.all = 7, 40  # SCL is low for 14 cycles, and the filter takes 15
        i2c.I2CDXR.all = 0x5A
        dsp.compute(5_000)

    def slave(dsp: Dsp) -> None:
        MidByteMaster("", False, 0x51, 0).start(dsp)
        i2c = dsp.module("I2C-A")
        i2c.I2CMDR.all = 0
        i2c.I2CPSC.all = 0
        i2c.I2CMDR.all = 0x0020
        while True:
            dsp.compute(600)
            if i2c.I2CSTR.RRDY:
                i2c.I2CDRR.all  # noqa: B018

    imu = small.unit("I2C-A", options={"i2c": {"noise_filter_cycles": 15}})
    case = small.case(unit={"head": small.unit("I2C-A"), "imu": imu})
    programs = small.given(head=master, imu=slave)
    by_edges, skipping = (run(case, disable, BUT_EDGES, "0.0001", programs) for disable in (BY_EDGES, SKIPPING))
    assert skipping[1] == by_edges[1]
    assert skipping[0].bytes_skipped == 2  # the address and the first byte
