"""Test benches that run one after the other within a simulator; tests of pytest check the findings of each."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from random import Random
from typing import Any

import cocotb
from cocotb.simtime import get_sim_time
from cocotb.triggers import RisingEdge, Timer
from cocotbext.i2c import I2cMaster, I2cMemory
from cocotbext.uart import UartSink, UartSource

from periph_sim.core import kernel
from periph_sim.cosim import F28335, OutsideError
from tests.cosim.benches import CASES, echo, run_settings

BEGAN: dict[str, int] = {}  # the step at which the part of each bench was created
LEFT: list[F28335] = []  # a part that a bench has not finished


def part(dut: Any, bench: str, *, bus: bool = True, serial: bool = False, **more: Any) -> F28335:
    """Return the case of this bench on the bus, the serial line or both, with log and records in the bench's folder."""
    folder = run_settings()[0] / bench
    folder.mkdir(exist_ok=True)
    BEGAN[bench] = get_sim_time("step")
    lines = {"scl": dut.scl, "scl_o": "dsp_scl", "sda": dut.sda, "sda_o": dut.dsp_sda} if bus else {}
    lines |= {"rx": dut.rx, "tx": dut.tx} if serial else {}
    return F28335(dut, CASES[bench], log=folder / "outside.jsonl", record=folder / "live.jsonl", **lines, **more)


def write_findings(bench: str, dsp: F28335, **found: Any) -> None:
    """Write the findings of a bench."""
    result = dsp.result
    found |= {
        "begin_ps": BEGAN[bench],
        "wire_bytes": result.wire_bytes,
        "nacked": result.counts["nacked"],
        "wakes": dsp.wakes,
    }
    found["kernel"] = kernel.__file__
    (run_settings()[0] / bench / "found.json").write_text(json.dumps(found))


async def read_rounds(
    dut: Any, bench: str, addresses: tuple[int, ...], count: int, speed: float, host: bool = False
) -> None:
    """Let cocotbext-i2c's master read from these addresses; each round is at a later phase of its millisecond."""
    _, settings = run_settings()
    dsp = part(dut, bench)
    master = I2cMaster(sda=dut.sda, sda_o=dut.other_sda, scl=dut.scl, scl_o=dut.other_scl, speed=speed)
    await Timer(1, "ms")
    got = []
    for number in range(settings["phases" if host else "rounds"]):
        await Timer(1_000_000 + number * 7_919, "ns")
        for address in addresses:
            await master.write(address, b"\x00")
            got.append(list(await master.read(address, count)))
            await master.send_stop()
            await Timer(60, "us")
    write_findings(bench, dsp, got=got)


@cocotb.test(timeout_time=3, timeout_unit="sec")
async def foreign_master(dut: Any) -> None:
    await read_rounds(dut, "foreign_master", (0x50,), 4, 200e3)


@cocotb.test(timeout_time=3, timeout_unit="sec")
async def foreign_master_400k(dut: Any) -> None:
    await read_rounds(dut, "foreign_master_400k", (0x50,), 4, 800e3)


@cocotb.test(timeout_time=3, timeout_unit="sec")
async def three_chips_and_a_host(dut: Any) -> None:
    await read_rounds(dut, "three_chips_and_a_host", (0x68, 0x53, 0x1E), 6, 200e3, host=True)


@cocotb.test(timeout_time=3, timeout_unit="sec")
async def frames_of_a_foreign_uart(dut: Any) -> None:
    """Frames begin at different phases of a round, from 1.2 ms before it to 1.2 ms after it; the chips are read."""
    _, settings = run_settings()
    dsp = part(dut, "frames_of_a_foreign_uart", serial=True)
    source = UartSource(dut.rx, baud=115_200)
    master = I2cMaster(sda=dut.sda, sda_o=dut.other_sda, scl=dut.scl, scl_o=dut.other_scl, speed=200e3)
    await Timer(2, "ms")
    got, phases = [], settings["phases"]
    for number in range(phases):
        phase = round(2_400_000 * number / phases) - 1_200_000

        async def frame(after: int, words: range) -> None:
            await Timer(after, "ns")
            source.write_nowait(struct.pack("<6h", *words))

        sends = cocotb.start_soon(frame(1_300_000 + phase, range(100 * number, 100 * number + 6)))
        await Timer(1_300_000, "ns")
        for address in (0x68, 0x53, 0x1E):
            await master.write(address, b"\x00")
            got.append(list(await master.read(address, 6)))
            await master.send_stop()
            await Timer(60, "us")
        await sends
        await source.wait()
        await Timer(500, "us")
    write_findings("frames_of_a_foreign_uart", dsp, got=got)


async def registers_against_a_dictionary(dut: Any, bench: str, speed: float) -> None:
    """Write and read registers of a slave at random; report reads that differ from a dictionary."""
    _, settings = run_settings()
    dsp = part(dut, bench)
    master = I2cMaster(sda=dut.sda, sda_o=dut.other_sda, scl=dut.scl, scl_o=dut.other_scl, speed=speed)
    draw, shadow, wrong = Random(bench), dict.fromkeys(range(256), 0), []
    await Timer(1, "ms")
    for _ in range(settings["rounds"] * 2):
        pointer, count = draw.randrange(256), draw.randint(1, 5)
        if draw.random() < 0.5:
            data = draw.randbytes(count)
            await master.write(0x50, bytes([pointer]) + data)
            shadow |= {(pointer + place) % 256: byte for place, byte in enumerate(data)}
        else:
            await master.write(0x50, bytes([pointer]))
            read = list(await master.read(0x50, count))
            if read != [shadow[(pointer + place) % 256] for place in range(count)]:
                wrong.append((pointer, read))
        await master.send_stop()
        await Timer(draw.randint(20, 200), "us")
    write_findings(bench, dsp, wrong=wrong)


@cocotb.test(timeout_time=3, timeout_unit="sec")
async def registers(dut: Any) -> None:
    await registers_against_a_dictionary(dut, "registers", 200e3)


@cocotb.test(timeout_time=3, timeout_unit="sec")
async def registers_400k(dut: Any) -> None:
    await registers_against_a_dictionary(dut, "registers_400k", 800e3)


@cocotb.test(timeout_time=3, timeout_unit="sec")
async def zero_hold_at_16_mhz(dut: Any) -> None:
    """SDA changes with the fall of SCL, and no edge is in the first tick of a cycle of SYSCLKOUT."""
    _, settings = run_settings()
    dsp = part(dut, "zero_hold_at_16_mhz")
    await Timer(1_000_000_367, "step")  # 1.1 ticks after the begin of a cycle; half a period is 93.75 ticks
    dut.period_ps.value, dut.quarter.value, dut.zero_hold.value, dut.count.value = 62_500, 40, 1, 6
    dut.pointer_a.value, dut.run.value = 0, 1
    got, before = [], int(dut.rounds_a.value)
    for number in range(settings["rounds"]):
        dut.go_a.value = 1
        await RisingEdge(dut.clk)
        await RisingEdge(dut.clk)
        dut.go_a.value = 0
        await until(lambda done=before + number + 1: int(dut.rounds_a.value) >= done, dut.clk)
        got.append(int(dut.data_a.value) & (1 << 48) - 1)
        await Timer(60, "us")
    dut.run.value = 0
    dut.period_ps.value, dut.quarter.value, dut.zero_hold.value, dut.count.value = 20_000, 125, 0, 4
    write_findings("zero_hold_at_16_mhz", dsp, got=got, nacks=int(dut.nacks_a.value))


@cocotb.test(timeout_time=3, timeout_unit="sec")
async def foreign_memory(dut: Any) -> None:
    """The firmware is the master, and the memory of cocotbext-i2c answers."""
    memory = I2cMemory(sda=dut.sda, sda_o=dut.other_sda, scl=dut.scl, scl_o=dut.other_scl, addr=0x53)
    memory.write_mem(0x32, bytes(range(0x40, 0x46)))
    dsp = part(dut, "foreign_memory")
    await dsp.finished()
    write_findings("foreign_memory", dsp)


@cocotb.test(timeout_time=3, timeout_unit="sec")
async def slave_in_logic(dut: Any) -> None:
    """The firmware is the master, and a slave in logic stretches SCL after each byte."""
    dut.run.value = 1
    dsp = part(dut, "slave_in_logic")
    await dsp.finished()
    dut.run.value = 0
    write_findings("slave_in_logic", dsp)


async def until(when: Callable[[], bool], clock: Any, cycles: int = 200_000) -> None:
    for _ in range(cycles // 100):
        if when():
            return
        await Timer(2, "us")
    raise AssertionError("the masters in logic did not finish")


@cocotb.test(timeout_time=3, timeout_unit="sec")
async def masters_in_logic(dut: Any) -> None:
    """Both masters start at once; arbitration is won by the one with the lower pointer."""
    dsp = part(dut, "masters_in_logic")
    before = [int(rounds.value) for rounds in (dut.rounds_a, dut.rounds_b)]
    await Timer(200_010, "ns")  # all rising edges of its clock are at cycle edges of SYSCLKOUT
    dut.clk.value, dut.run.value = 0, 1
    dut.pointer_a.value, dut.pointer_b.value = 0x10, 0x08
    dut.go_a.value = dut.go_b.value = 1
    await RisingEdge(dut.clk)
    await RisingEdge(dut.clk)
    dut.go_a.value = dut.go_b.value = 0
    await until(lambda: int(dut.rounds_a.value) > before[0] and int(dut.rounds_b.value) > before[1], dut.clk)
    await Timer(20, "us")
    dut.run.value = 0
    names = ("data_a", "data_b", "losses_a", "losses_b", "nacks_a", "nacks_b")
    write_findings("masters_in_logic", dsp, **{name: int(getattr(dut, name).value) for name in names})


@cocotb.test(timeout_time=3, timeout_unit="sec")
async def serial_line(dut: Any) -> None:
    """Firmware answers each character of cocotbext-uart with the next one."""
    dsp = part(dut, "serial_line", bus=False, serial=True, programs={"dsp": echo()})
    source, sink = UartSource(dut.rx, baud=115_200), UartSink(dut.tx, baud=115_200)
    await Timer(1, "ms")
    await source.write(bytes(range(40, 80)))
    await dsp.finished()
    write_findings("serial_line", dsp, got=list(sink.read_nowait()), framing=dsp.peek("SCI-A.SCIRXST.FE"))


def answer(call: Callable[..., object], *arguments: Any, **more: Any) -> str:
    """Return the result of a call as text; if it raises an error, the sentence of the error."""
    try:
        return str(call(*arguments, **more))
    except ValueError as error:
        return str(error)


@cocotb.test(timeout_time=3, timeout_unit="sec")
async def refusals(dut: Any) -> None:
    """Collect the error message of each impossible call."""
    case = CASES["foreign_master"]
    lines = {"scl": dut.scl, "scl_o": dut.dsp_scl, "sda": dut.sda, "sda_o": dut.dsp_sda}
    made: dict[str, dict[str, Any]] = {
        "no line": {},
        "half": {"scl": dut.scl},
        "no signal": lines | {"sda_o": "dsp_sdb"},
        "no wire": lines | {"wires": {"SDC": (dut.rx, None)}},
        "no file": lines | {"log": "/nowhere/log.jsonl"},
        "one file": lines | {"log": "/nowhere/a", "record": "/nowhere/a"},
    }
    sentences = {name: answer(F28335, dut, case, **given) for name, given in made.items()}
    dsp = F28335(dut, case, **lines)
    for place in ("I2C-A.I2CSTR.SCD", "I2C-A.I2CSTX"):
        sentences[place] = answer(dsp.peek, place)
    await Timer(1, "us")
    for level in "xz":
        dut.rx.value = level
        await Timer(1, "ns")
        sentences[level] = answer(F28335, dut, CASES["serial_line"], rx=dut.rx)
    dut.rx.value = 1
    LEFT.append(dsp)
    (run_settings()[0] / "refusals.json").write_text(json.dumps(sentences))


@cocotb.test(
    expect_error=OutsideError, timeout_time=1, timeout_unit="ms", skip=run_settings()[1]["simulator"] == "verilator"
)
async def a_line_that_loses_its_level(dut: Any) -> None:
    """The error ends the test, although nothing awaits the part. Verilator has no x."""
    F28335(dut, CASES["serial_line"], rx=dut.rx)
    await Timer(1, "us")
    dut.rx.value = "x"
    await Timer(10, "us")


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def what_a_test_left_is_over_with_it(dut: Any) -> None:
    """A START and clocks would wake a part that was left by an earlier test."""
    (left,) = LEFT
    wakes = left.wakes
    dut.other_sda.value = 0
    for level in (0, 1) * 9:
        await Timer(5, "us")
        dut.other_scl.value = level
    await Timer(5, "us")
    dut.other_sda.value = 1
    await Timer(5, "us")
    assert left.wakes == wakes > 0
