"""What decides which code runs: settings and waits are closed, data, flags and what is not followed are open."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.explain.bound.branches import Decisions
from periph_sim.explain.bound.code_trace import Ran
from periph_sim.explain.bound.deadlines import deadlines
from periph_sim.explain.bound.form_of_case import closed_form
from periph_sim.explain.bound.program import Program
from periph_sim.scene.firmware_loader import load_firmware
from tests.explain.bound.cases import imu_hil

FIRMWARE = """
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal
import os

LENGTH = 12
COSTS = {{0: 5, 1: 9}}
seen = []


@dataclass
class Settings:
    fast: bool = False
    cost: int = 9
    order: tuple[int, ...] = (1, 2)


class Emulator:
    def __init__(self, dsp, settings):
        self.dsp = dsp
        self.settings = settings
        self.i2c = dsp.module("I2C-A")
        self.sci = dsp.module("SCI-A") if dsp.has("SCI-A") else None
        self.cost, self.helper = prepared(settings)
        self.frame = bytes(LENGTH)
        self.queue = []
        self.count = 0

    def received(self):
        self.frame = bytes(self.sci.SCIRXBUF.all & 0xFF for _ in range(LENGTH))
        self.count += 1

    def work(self, cost):
        self.dsp.compute(cost)

    def other(self):
        pass

    def serve(self, data):
        dsp, i2c, settings = self.dsp, self.i2c, self.settings
        frame = self.frame
        {body}


def prepared(settings):
    return settings.cost * 2, object()


def rare(dsp):
    if seen:
        dsp.compute(3)


def main(dsp, settings):
    emulator = Emulator(dsp, settings)
    while True:
        emulator.serve(emulator.frame)
"""


def decisions(folder: Path, body: str) -> list[str]:
    """The open decisions of `serve` with this body, without their place."""
    file = folder / "firmware_under_test.py"
    file.write_text(FIRMWARE.format(body=body.replace("\n", "\n        ")), encoding="utf-8")
    program = Program(load_firmware(str(file)).main)
    found = Decisions(program).open({Ran(code_of(file, "serve"))})
    assert all(each.file == str(file) for each in found)
    return [each.what for each in found]


def code_of(file: Path, name: str):
    """The code of a method, as a frame has it."""
    return vars(load_firmware(str(file)).main.__globals__["Emulator"])[name].__code__


@pytest.mark.parametrize(
    "body",
    [
        "dsp.compute(100)",
        "if settings.fast:\n    dsp.compute(1)",
        "if not settings.fast and settings.cost > 3:\n    dsp.compute(1)",
        "if self.settings.fast:\n    i2c.I2CDXR.all = 1\nelse:\n    return",
        "if self.sci is not None:\n    self.sci.SCITXBUF.all = 1",
        "for address in settings.order:\n    if address == 2:\n        i2c.I2COAR.all = address",
        "for n in range(LENGTH):\n    i2c.I2CDXR.all = data[n]",
        "for n, address in enumerate(sorted(settings.order)):\n    i2c.I2COAR.all = address",
        "dsp.compute(self.cost)",
        "dsp.compute(self.cost + settings.cost * 2, 'work')",
        "dsp.compute(cost=settings.cost)",
        "dsp.spin(lambda: i2c.I2CSTR.AAS == 1)",
        "while True:\n    if dsp.spin_either(lambda: i2c.I2CSTR.XRDY, lambda: i2c.I2CSTR.SCD):\n        break",
        "while not dsp.spin_either(lambda: i2c.I2CSTR.RRDY == 1, lambda: i2c.I2CSTR.AAS == 0):\n    i2c.I2CDRR.all",
        "over = dsp.spin_either(lambda: i2c.I2CSTR.XRDY == 1, lambda: i2c.I2CSTR.SCD == 1)\nif over:\n    return",
        "self.work(settings.cost)",
        "with dsp.span('part'):\n    i2c.I2CDXR.all = frame[0]",
        "x = frame[0] if frame[1] else 7\ni2c.I2CDXR.all = x",  # decides a value, and not what runs
        "for byte in frame:\n    seen.append(byte)\n    if byte:\n        break",  # takes no time
        "if frame[0]:\n    seen.append(frame)",
        "if frame[0]:\n    self.other()",
        "if frame[0]:\n    seen.append(dsp)",  # no method of a list takes time
    ],
)
def test_what_settings_and_waits_decide_is_closed(tmp_path, body: str):
    assert decisions(tmp_path, body) == []


@pytest.mark.parametrize(
    ("body", "what"),
    [
        ("if frame[0] & 1:\n    dsp.compute(100)", "'if frame[0] & 1' decides what runs"),
        ("if data[0]:\n    i2c.I2CDXR.all = 1", "'if data[0]' decides what runs"),
        ("if self.queue:\n    dsp.compute(1)", "'if self.queue' decides what runs"),
        ("if seen:\n    dsp.compute(1)", "'if seen' decides what runs"),
        ("if self.count % 2:\n    dsp.eallow()", "'if self.count % 2' decides what runs"),
        ("if os.urandom(1)[0]:\n    return", "'if os.urandom(1)[0]' decides what runs"),
        ("if i2c.I2CSTR.SDIR == 1:\n    i2c.I2CDXR.all = 1", "'if i2c.I2CSTR.SDIR == 1' decides what runs"),
        ("while i2c.I2CSTR.BB == 1:\n    pass", "'while i2c.I2CSTR.BB == 1' decides how often code runs"),
        ("for byte in data:\n    i2c.I2CDXR.all = byte", "'for ... in data' decides how often code runs"),
        ("for n in range(frame[0]):\n    dsp.compute(1)", "'for ... in range(frame[0])' decides how often code runs"),
        ("[dsp.compute(1) for _ in data]", "'for ... in data' decides how often code runs"),
        ("[dsp.compute(1) for n in range(9) if frame[n]]", "'if frame[n]' decides what runs"),
        ("dsp.compute(len(data))", "'len(data)' decides what a computation costs"),
        ("dsp.compute(frame[0] + settings.cost)", "'frame[0] + settings.cost' decides what a computation costs"),
        ("dsp.compute(COSTS[self.count])", "'COSTS[self.count]' decides what a computation costs"),
        ("cost = 1\nif frame[0]:\n    cost = 2\ndsp.compute(cost)", "'cost' decides what a computation costs"),
        ("frame[0] and dsp.compute(4)", "'frame[0]' decides what runs"),
        ("dsp.compute(4) if frame[0] else None", "'if frame[0]' decides what runs"),
        ("match frame[0]:\n    case 1:\n        dsp.compute(1)", "'match frame[0]' decides what runs"),
        ("try:\n    dsp.compute(1)\nexcept ValueError:\n    pass", "an exception decides what runs"),
        ("[self.work, self.other][frame[0]](3)", "'[self.work, self.other][frame[0]]' decides which f..."),
        ("work = self.frame\nwork(dsp)", "'work' decides which function runs"),
        ("dsp.spin(lambda: i2c.I2CSTR.AAS == 1, timeout=100)", "a wait may time out"),
        ("for byte in frame:\n    if byte:\n        return\ndsp.compute(1)", "'if byte' decides what runs"),
        ("self.work(frame[0])", "'cost' decides what a computation costs"),
        ("rare(dsp)", "'if seen' decides what runs"),
        (
            "def maybe(cost):\n    if cost is None:\n        dsp.compute(1)\nseen.append(maybe)\nmaybe(3)",
            "'if cost is None' d...",
        ),
        (
            "if frame[0]:\n    os.truncate(dsp)",
            "'if frame[0]' decides what runs",
        ),  # who knows what it does with the DSP
    ],
)
def test_what_data_or_flags_decide_is_open(tmp_path, body: str, what: str):
    found = decisions(tmp_path, body)
    assert [each for each in found if each.startswith(what.removesuffix("..."))], found


def test_the_functions_that_serve_in_this_repository_are_as_they_look():
    """The emulator's path is closed but where models run frame by frame; a responder looks at SDIR to find out what it
    is asked for."""
    emulator, responder = (load_firmware(name).main for name in ("imu_hil", "responder"))
    found = {(Path(each.file).stem, each.what) for each in Decisions(Program(emulator)).open({Ran(emulator.__code__)})}
    assert {what for file, what in found if file != "startup"} == {"'if not ran' decides what runs"}
    open_ones = {each.what for each in Decisions(Program(responder)).open({Ran(responder.__code__)})}
    assert "'if i2c.I2CSTR.SDIR == 1' decides what runs" in open_ones


def test_what_has_no_source_is_open():
    names: dict[str, object] = {}
    exec("def main(dsp, settings):\n    dsp.compute(1)\n", names)
    (found,) = Decisions(Program(names["main"])).open({Ran(names["main"].__code__)})  # type: ignore[arg-type, attr-defined]
    assert found.what == "the source of main cannot be read"


def test_of_a_loop_that_goes_on_for_ever_only_the_loop_counts(tmp_path):
    file = tmp_path / "looping.py"
    file.write_text(
        "def main(dsp, settings):\n"
        "    if dsp.module('SYS').WDCR.WDDIS:\n"
        "        dsp.compute(1)\n"
        "    while True:\n"
        "        dsp.compute(2)\n"
        "        dsp.eallow()\n",
        encoding="utf-8",
    )
    main = load_firmware(str(file)).main
    read = Decisions(Program(main))
    assert read.open({Ran(main.__code__, 5, 6)}) == ()
    assert [each.line for each in read.open({Ran(main.__code__, 2, 6)})] == [2]
    assert [each.line for each in read.open({Ran(main.__code__)})] == [2]


def test_the_same_code_is_read_once_however_many_terms_it_is_in(monkeypatch: pytest.MonkeyPatch):
    read: list[object] = []
    real = Program.called_from

    def counted(program: Program, parts):
        parts = list(parts)
        read.extend(parts)
        return real(program, parts)

    monkeypatch.setattr(Program, "called_from", counted)
    closed = closed_form(imu_hil())
    assert closed.bounds(deadlines(closed))
    assert 0 < len(read) < 50  # for some 3200 terms


def test_what_is_computed_once_is_known_and_what_is_computed_anew_each_time_is_not(tmp_path):
    file = tmp_path / "anew.py"
    file.write_text(
        "def cost(settings):\n"
        "    return settings.cost\n"
        "def main(dsp, settings):\n"
        "    once = cost(settings)\n"
        "    while True:\n"
        "        dsp.compute(once)\n"
        "        dsp.compute(cost(settings))\n",
        encoding="utf-8",
    )
    main = load_firmware(str(file)).main
    found = Decisions(Program(main)).open({Ran(main.__code__)})
    assert [(each.line, each.what) for each in found] == [(7, "'cost(settings)' decides what a computation costs")]
