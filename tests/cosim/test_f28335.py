"""A case in Icarus Verilog with masters, memories and UARTs of other projects, and its replay without a simulator."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from periph_sim.core import kernel
from tests.cosim.benches import CASES, found, replayed, run_benches
from tests.profiles import explores

pytestmark = pytest.mark.uncounted
CYCLE = 20  # ticks of a cycle of SYSCLKOUT
CHIPS = [list(range(first, first + 6)) for first in (0x11, 0x21, 0x31)]


@pytest.fixture(scope="module")
def benches(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Run all benches once."""
    folder = tmp_path_factory.mktemp("benches")
    run_benches(folder, rounds=3, phases=8)
    yield folder


def read_by_us(folder: Path, bench: str) -> list[str]:
    """Return the bytes of the first read by the firmware's master, as in the records of the bus monitor."""
    records = [json.loads(line) for line in (folder / bench / "live.jsonl").read_text().splitlines()]
    bus = [record[4:6] for record in records if isinstance(record, list) and record[2] == "bus"]
    begin = bus.index(["repeated START", None])
    return [text for what, text in bus[begin : begin + 8] if what == "byte"]


def falls(folder: Path, bench: str) -> list[int]:
    """Return the ticks at which a master outside drove SCL low, from the begin of the case."""
    instants = [json.loads(text) for text in (folder / bench / "outside.jsonl").read_text().splitlines()]
    return [instant[0] for instant in instants if isinstance(instant, list) and instant[1].get("SCL") == 0]


def chips(number: int) -> list[list[int]]:
    """Return what the three chips show after a frame."""
    roll, pitch, yaw, *accelerations = range(100 * number, 100 * number + 6)
    words = (">3h", roll, pitch, yaw), ("<3h", *accelerations), (">3h", roll, yaw, pitch)
    return [list(struct.pack(form, *values)) for form, *values in words]


def check(folder: Path, rounds: int, phases: int) -> None:
    """Check the findings of all benches, and that their replays without a simulator give the same records."""
    found_of: dict[str, dict[str, Any]] = {bench: found(folder, bench) for bench in CASES}
    for bench in ("foreign_master", "foreign_master_400k"):
        assert found_of[bench]["got"] == [[1, 2, 3, 4]] * rounds
        assert found_of[bench]["wire_bytes"] == 7 * rounds
    host = found_of["three_chips_and_a_host"]
    assert host["got"] == CHIPS * phases
    assert (
        host["wakes"] < 35 * host["wire_bytes"]
    )  # 52 without shortcuts, when every edge and every step of the firmware wakes the simulator
    frames = found_of["frames_of_a_foreign_uart"]["got"]
    assert len(frames) == 3 * phases
    for number in range(1, phases):
        for place, data in enumerate(frames[3 * number : 3 * number + 3]):
            assert data in (chips(number)[place], chips(number - 1)[place])
    assert found_of["registers"]["wrong"] == found_of["registers_400k"]["wrong"] == []
    assert found_of["zero_hold_at_16_mhz"]["got"] == [0x5AA500FF817E] * rounds
    assert all(tick % CYCLE for tick in falls(folder, "zero_hold_at_16_mhz"))
    masters = found_of["masters_in_logic"]  # the lower pointer wins arbitration, and the other master follows
    assert (masters["losses_a"], masters["losses_b"]) == (1, 0)
    assert (masters["data_a"] & 0xFFFFFFFF, masters["data_b"]) == (0x05060708, 0x01020304)
    assert (masters["nacks_a"], masters["nacks_b"], masters["wire_bytes"]) == (0, 0, 14)
    assert not any(tick % CYCLE for tick in falls(folder, "masters_in_logic"))
    assert found_of["serial_line"]["got"] == list(range(41, 81))
    assert found_of["serial_line"]["framing"] == 0
    assert found_of["foreign_memory"]["wire_bytes"] >= 5 * 9
    assert found_of["slave_in_logic"]["wire_bytes"] == 2 * 9
    values = [f"0x{value:02X} {'NACK' if value % 8 == 5 else 'ACK'}" for value in range(0x40, 0x46)]
    assert read_by_us(folder, "foreign_memory") == values
    values = [f"0x{value:02X} {'NACK' if value == 0x32 else 'ACK'}" for value in range(0x2D, 0x33)]
    assert read_by_us(folder, "slave_in_logic") == values
    masters_of = [bench for bench in CASES if bench not in ("foreign_memory", "slave_in_logic", "serial_line")]
    assert [bench for bench in masters_of if found_of[bench]["nacked"]] == []
    assert [bench for bench in CASES if not replayed(folder, bench)] == []


def test_benches_and_their_replay_without_a_simulator(benches: Path) -> None:
    check(benches, rounds=3, phases=8)


def test_the_simulator_runs_the_same_form_of_the_core(benches: Path) -> None:
    assert found(benches, "registers")["kernel"] == kernel.__file__


def test_impossible_calls_are_refused_in_one_sentence(benches: Path) -> None:
    said = json.loads((benches / "refusals.json").read_text())
    assert said["no line"] == "no line is given; give scl, scl_o, sda, sda_o, rx or tx"
    assert said["half"].startswith("scl and scl_o go together: the resolved line, and a register for our own pull")
    assert said["no signal"] == "SDA: bus has no signal 'dsp_sdb'; did you mean dsp_sda or dsp_scl?"
    assert "there is no wire 'SDC'; did you mean SDA or SCL?" in said["no wire"]
    assert said["no file"] == "/nowhere/log.jsonl: No such file or directory; give the log another place"
    assert said["one file"] == "/nowhere/a: log and record are the same file; give different files"
    assert said["x"].startswith("bus.rx (line RX) is x at the beginning: two drivers disagree, or one has no value yet")
    assert said["z"].startswith("bus.rx (line RX) is z at the beginning: nothing drives it; give it a pull-up")
    assert said["I2C-A.I2CSTR.SCD"] == "0"
    assert said["I2C-A.I2CSTX"].startswith("I2C-A.I2CSTX: I2C-A has no register 'I2CSTX'; did you mean I2CSTR")


@pytest.mark.skipif(not explores(), reason="in `make explore`")
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("simulator", ["icarus", "verilator"])
def test_two_hundred_rounds_of_each_party(simulator: str, tmp_path: Path) -> None:
    """Each round is at a later phase of its millisecond, so that all phases of the host's frames occur."""
    run_benches(tmp_path, rounds=200, phases=200, simulator=simulator)
    check(tmp_path, rounds=200, phases=200)
