"""Fault agents on wires without other devices, as timing diagrams. A column is 10 ns."""

from __future__ import annotations

from dataclasses import fields
from fractions import Fraction
from functools import partial
from random import Random

import pytest

from periph_sim.bus.faults import FaultContext, When, kinds
from periph_sim.core.convert import BadTable, convert
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.sampler import watch
from periph_sim.core.wire import Wire
from tests.waves import DiagramRig


class FaultRig(DiagramRig):
    """A fault agent and a partner on three wires.

    Rows of a diagram: SCL, SDA and dsp.XRS are the levels of the wires; scl and sda are what the partner drives.
    """

    def __init__(self, kind: str, seed: int = 0, **settings: object) -> None:
        self.kernel = Kernel()
        self.wires = {name: Wire(self.kernel, name, Recorder()) for name in ("SCL", "SDA", "dsp.XRS")}
        self.partner = {name.lower(): wire.attach("partner") for name, wire in self.wires.items()}
        place = FaultContext(self.kernel, "fault 0", self.wires.__getitem__, self._ticks, 0, Random(seed))
        kinds()[kind].attach(convert(kinds()[kind].Settings, settings), place)

    def _ticks(self, seconds: Fraction) -> int:
        return int(seconds * 10**9)

    def columns(self) -> tuple[int, int]:
        return 10, 0  # ticks, which are ns

    def drive(self, now: int, signal: str, level: int) -> None:
        self.kernel.call_at(now, partial(self.partner[signal].drive, level))

    def run_until(self, time: int) -> None:
        self.kernel.run_until(time)

    def show(self, signal: str) -> int:
        return self.wires[signal].level

    def falls(self, signal: str, until: int) -> list[int]:
        found: list[int] = []
        watch([self.wires[signal]], lambda tick, level: None if level else found.append(tick))
        self.run_until(until)
        return found


DIAGRAMS = [
    pytest.param(
        "spike",
        {"wire": "SCL", "at": "30 ns", "width": "20 ns"},
        """
        < SCL  1..0.1....
        < SDA  1.........
        """,
        id="a spike is a short low level and leaves the other line unchanged",
    ),
    pytest.param(
        "spike",
        {"wire": "SCL", "at": "40 ns", "width": "20 ns"},
        """
        > scl  1.0..1....
        < SCL  1.0...1...
        """,
        id="a spike on a low line is visible only after the line is released",
    ),
    pytest.param(
        "hold",
        {"wire": "SDA", "at": "20 ns", "length": "60 ns"},
        """
        > sda  1....0...1
        < SDA  1.0......1
        """,
        id="a line is held for a length",
    ),
    pytest.param(
        "hold",
        {"wire": "SDA", "at": "20 ns", "every": "50 ns", "times": 3, "length": "60 ns"},
        """
        < SDA  1.0...............1..
        """,
        id="a line that is held again is released after the last length",
    ),
    pytest.param(
        "hold",
        {"wire": "SDA", "at": "40 ns", "clocks": 2},
        """
        > scl  10101.010101010
        < SDA  1...0...1......
        """,
        id="a line is held until scl has fallen the given number of times",
    ),
    pytest.param(
        "reset",
        {"unit": "dsp", "at": "20 ns", "length": "40 ns"},
        """
        < dsp.XRS  1.0...1...
        < SDA      1.........
        """,
        id="a reset pulls the reset pin of the unit low",
    ),
    pytest.param(
        "condition",
        {"at": "30 ns", "late": "20 ns"},
        """
        > scl  1.0.1...0.1...0..
        > sda  1..0.....1.......
        < SCL  1.0.1...0.1...0..
        < SDA  1..0.....1..0.1..
        """,
        id="a false start is a fall of sda within the next 1",
    ),
    pytest.param(
        "condition",
        {"condition": "STOP", "at": "30 ns", "late": "20 ns"},
        """
        > scl  1.0.1...0.1...0..
        > sda  1..0.....1.......
        < SCL  1.0.1...0.1...0..
        < SDA  1..0........1....
        """,
        id="a false stop is a rise of sda within the next 1",
    ),
    pytest.param(
        "condition",
        {"at": "50 ns", "late": "30 ns"},
        """
        > scl  1.0.1.0.1.........0.1...0.
        > sda  1..0......1......0.1......
        < SDA  1..0......1......0.1...01.
        """,
        id="the clock of a stop is not a bit and no false start is put in it",
    ),
    pytest.param(
        "condition",
        {"at": "10 ns", "late": "20 ns"},
        """
        > scl  1.0.1.........................0.
        > sda  1............................0..
        < SDA  1.....0...................1..0..
        """,
        id="a false start ends if no clock follows while sda is low",
    ),
    pytest.param(
        "flip",
        {"at": "30 ns"},
        """
        > scl  1.0.1.0.1.0.1.0.
        > sda  1..0...1........
        < SCL  1.0.1.0.1.0.1.0.
        < SDA  1..0......1.....
        """,
        id="a flipped bit is the next 1 for one clock",
    ),
    pytest.param(
        "flip",
        {"at": "10 ns"},
        """
        > scl  1.0.1...0.1.0.
        > sda  1..0..1.......
        < SDA  1.0...1.0...1.
        """,
        id="a flip does not prevent a stop",
    ),
    pytest.param(
        "flip",
        {"at": "30 ns"},
        """
        > scl  1.0.1.0.1.........................0.1.
        > sda  1..0...1.......................0......
        < SDA  1..0........................1..0......
        """,
        id="a flip ends if no clock follows while sda is low",
    ),
]


@pytest.mark.parametrize(("kind", "settings", "diagram"), DIAGRAMS)
def test_diagram(kind: str, settings: dict[str, object], diagram: str):
    FaultRig(kind, **settings).check(diagram)


def test_a_held_line_names_the_fault_that_holds_it():
    rig = FaultRig("hold", wire="SDA", at="20 ns", length="60 ns")
    rig.run_until(50)
    assert rig.wires["SDA"].held_by() == ["fault 0"]


def test_repeated_faults_are_late_by_a_random_part_of_the_spread():
    settings = {"wire": "SDA", "at": "1 us", "every": "500 ns", "spread": "200 ns", "times": 20, "width": "10 ns"}
    falls = FaultRig("spike", seed=4, **settings).falls("SDA", 10**6)
    late = [fall - 1000 - 500 * number for number, fall in enumerate(falls)]
    assert len(falls) == 20 and len(set(late)) > 10 and all(0 <= tick <= 200 for tick in late)
    assert falls == FaultRig("spike", seed=4, **settings).falls("SDA", 10**6)
    assert falls != FaultRig("spike", seed=5, **settings).falls("SDA", 10**6)


def test_a_fault_without_every_occurs_once_and_without_times_endlessly():
    once = {"wire": "SDA", "at": "0 ns", "width": "10 ns"}
    assert FaultRig("spike", **once).falls("SDA", 10**6) == [0]
    assert len(FaultRig("spike", **once, every="100 ns").falls("SDA", 10**6)) == 10**4 + 1


@pytest.mark.parametrize(
    ("kind", "settings", "sentence"),
    [
        ("spike", {"at": "1 us", "wire": "SCL", "width": "0 s"}, "it must be longer than 0"),
        ("spike", {"at": 3, "wire": "SCL", "width": "1 us"}, '3 has no unit; write for instance "3 ms"'),
        ("spike", {"at": "-1 us", "wire": "SCL", "width": "1 us"}, "'-1 us' is negative; a duration is 0 or more"),
        ("spike", {"at": "1 us", "times": 3, "wire": "SCL", "width": "1 us"}, "'times' needs 'every'"),
        (
            "spike",
            {"at": "1 us", "every": "1 us", "spread": "2 us", "wire": "SCL", "width": "1 us"},
            "'spread' is longer than 'every', so faults would be out of order; shorten 'spread'",
        ),
        ("hold", {"at": "1 us", "wire": "SDA"}, "either for a length or for a number of clocks; give one of them"),
        ("hold", {"at": "1 us", "wire": "SDA", "length": "1 us", "clocks": 9}, "give one of them"),
        ("hold", {"at": "1 us", "wire": "SDA", "clocks": 0}, "expected 1 or more"),
    ],
)
def test_contradictory_settings_are_rejected(kind: str, settings: dict[str, object], sentence: str):
    with pytest.raises(BadTable) as caught:
        FaultRig(kind, **settings)
    assert sentence in str(caught.value)


@pytest.mark.parametrize("name", kinds())
def test_every_kind_of_fault_has_the_settings_of_its_time(name: str):
    assert issubclass(kinds()[name].Settings, When)
    assert {"at", "every", "spread", "times"} <= {f.name for f in fields(kinds()[name].Settings)}
