"""SCI frames above edges: the level "adaptive" gives what "edge" gives, record by record, whoever sends and meddles.

    wire      ~~|___|~~|___|~~~~~~|__|~~~~
    adaptive  ~~|____________________|~~~~    the edges between are told behind

Firmware may change the format, the rate, the pins and the clocks of an SCI, look at its lines and reset it at any time;
who sends from outside may be off in rate and format, send wrong characters and breaks.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

import pytest

from periph_sim.core.records import Kind
from periph_sim.firmware import start_sci
from periph_sim.processor.dsp import Dsp
from periph_sim.scene.case.load import load
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.result import FRAMES, FRAMES_PASSED
from periph_sim.scene.scene import Scene
from tests.profiles import explores
from tests.scene import small
from tests.scene.runs import TIMING
from tests.scene.test_adaptive import BUT_EDGES, RECORDED, run, told

BUT_PADS = tuple(kind for kind in BUT_EDGES if kind is not Kind.FLAG)  # flags of the pads that TX moves
FORMATS = (0x07, 0x07, 0x27, 0x67, 0x87, 0x06, 0x0F, 0x6F, 0x01)  # SCICCR: bits, parity, stop bits, address bit
RATES = (40, 40, 40, 41, 39, 43, 20, 80, 1)


class Meddler:
    """Firmware that sends, receives and, at times drawn by a seed, does what shows in the middle of a frame."""

    def __init__(self, seed: int, module: str, calm: bool) -> None:
        self.random = Random(f"{seed} {module} firmware")
        self.module = module
        self.calm = calm  # it only sends and receives
        self.seen: list[tuple[str, int, int]] = []  # what was done, at which cycle, what was seen

    def __call__(self, dsp: Dsp, settings: object) -> None:
        draw = self.random
        self.started(dsp)
        sci, system = dsp.module(self.module), dsp.module("SYS")
        doings: dict[str, Any] = {
            "send": lambda: self.put(sci.SCITXBUF, draw.choice((0, 0xFF, 0x55, draw.randrange(256)))),
            "send more": lambda: self.put(sci.SCITXBUF, *(draw.randrange(256) for _ in range(draw.randrange(1, 9)))),
            "receive": lambda: sci.SCIRXBUF.all,
            "look at flags": lambda: sci.SCIRXST.all << 16 | sci.SCIFFRX.all,
            "clear flags": lambda: self.put(sci.SCIFFRX, 0x6040 | draw.randrange(16)),
        }
        meddling: dict[str, Any] = {
            "format": lambda: self.put(sci.SCICCR, draw.choice(FORMATS)),
            "rate": lambda: self.put(sci.SCILBAUD, draw.choice(RATES)),
            "start again": lambda: self.started(dsp),
            "reset": lambda: self.off_and_on(sci),
            "halves": lambda: self.put(sci.SCICTL1, draw.choice((0x23, 0x21, 0x22, 0x27, 0x2B, 0x63))),
            "transmit FIFO": lambda: self.put(sci.SCIFFTX, draw.choice((0xE000, 0xE000, 0x6000, 0xA000))),
            "autobaud": lambda: self.put(sci.SCIFFCT, draw.choice((0x6000, 0x4000, 0x0000, 0x0003))),
            "loop-back": lambda: self.put(sci.SCICCR, draw.choice((0x17, 0x07, 0x07))),
            "clock": lambda: self.clock(dsp, system),
            "LSPCLK": lambda: self.protected(dsp, system.LOSPCP, "all", draw.choice((2, 2, 1))),
            "PLL": lambda: self.protected(dsp, system.PLLSTS, "DIVSEL", draw.choice((2, 2, 1))),
        }
        if dsp.has("GPIO"):
            gpio = dsp.module("GPIO")
            meddling |= {
                "look at the pads": lambda: gpio.GPADAT.all >> 16,
                "take the pins": lambda: self.pins(dsp, gpio),
                "qualify": lambda: self.protected(dsp, gpio.GPAQSEL2, "GPIO28", draw.choice((3, 3, 0, 1))),
            }
        if not self.calm:
            doings |= meddling
        while True:
            dsp.compute(draw.choice((3, 40, 700, 5_000, 20_000)) + draw.randrange(1_000))
            what = draw.choice(list(doings))
            seen = doings[what]()
            self.seen.append((what, dsp.cpu.cycle, int(seen or 0)))

    def started(self, dsp: Dsp) -> None:
        rate, form = self.random.choice(RATES[:5]), self.random.choice(FORMATS[:6])
        start_sci(dsp, self.module, *((40, 0x07) if self.calm else (rate, form)))

    @staticmethod
    def put(register: Any, *values: int) -> None:
        for value in values:
            register.all = value

    @staticmethod
    def off_and_on(sci: Any) -> None:
        sci.SCICTL1.SWRESET = 0
        sci.SCICTL1.SWRESET = 1

    def protected(self, dsp: Dsp, register: Any, field: str, value: int) -> None:
        dsp.eallow()
        setattr(register, field, value)
        dsp.edis()

    def clock(self, dsp: Dsp, system: Any) -> None:
        gate = f"SCI{self.module[-1]}ENCLK"
        self.protected(dsp, system.PCLKCR0, gate, 0)
        dsp.compute(self.random.randrange(3_000))
        self.protected(dsp, system.PCLKCR0, gate, 1)

    def pins(self, dsp: Dsp, gpio: Any) -> None:
        draw = self.random
        dsp.eallow()
        gpio.GPADIR.all = draw.choice((0, 1 << 29, 1 << 28))
        gpio.GPAMUX2.all = 0
        dsp.compute(draw.randrange(3_000))
        gpio.GPADIR.all = 0
        gpio.GPAMUX2.all = 0x05000000
        dsp.edis()


def bursts(seed: int, to: str, calm: bool) -> dict[str, Any]:
    """[serial]: what is sent from outside."""
    draw = Random(f"{seed} outside")
    sends: list[dict[str, Any]] = []
    for n in range(draw.randrange(2, 6)):
        at = f"{draw.randrange(100, 8_000)} us"
        if not calm and draw.random() < 0.2:
            sends.append({"to": to, "at": at, "break": f"{draw.randrange(1, 300)} us"})
            continue
        data = bytes(draw.choice((0, 0xFF, 0x41, 0x61, draw.randrange(256))) for _ in range(draw.randrange(1, 20)))
        one: dict[str, Any] = {"to": to, "at": at, "bytes": data.hex(" "), "gap": f"{draw.choice((0, 0, 7, 90))} us"}
        if not calm:
            one |= {"baud": draw.choice((115_200, 114_000, 119_000, 57_600, 230_400, 100_000))}
            one |= {"parity": draw.choice(("none", "none", "even")), "stop": draw.choice((1, 1, 2))}
            if draw.random() < 0.3:
                one |= {"missing_stop": [draw.randrange(len(data))]}
            if draw.random() < 0.3 and one["parity"] == "even":
                one |= {"wrong_parity": [draw.randrange(len(data))]}
            if draw.random() < 0.2:
                one |= {"multiprocessor": "address-bit", "address": draw.randrange(256)}
        sends.append({"name": f"{n}", **one})
    return {"ppm": draw.choice((0, 137, -2_000)), "send": sends}


def alone(seed: int, level: str, kinds: tuple[Kind, ...], calm: bool = False):
    """One unit, whose SCI-A others send to, and whose TX is listened to."""
    meddler = Meddler(seed, "SCI-A", calm)
    budget = [{"name": "most", "measure": "fifo high-water", "max": 3}]
    modules = ["SCI-A", "GPIO"] if seed % 3 else ["SCI-A"]
    unit = {"dsp": {"firmware": "meddler", "modules": modules, "ppm": seed % 5 * 10}}
    case = small.case(unit=unit, serial=bursts(seed, "dsp.SCI-A", calm), budget=budget if seed % 2 else [])
    return *run(case, level, kinds, "0.01", {"dsp": Firmware("meddler", meddler, None)}), meddler.seen


def joined(seed: int, level: str, kinds: tuple[Kind, ...], calm: bool = False):
    """Two units whose SCIs are joined both ways; each has its own clock."""
    meddlers = {"left": Meddler(seed, "SCI-A", calm), "right": Meddler(seed, "SCI-B", calm)}
    programs = {name: Firmware("meddler", meddler, None) for name, meddler in meddlers.items()}
    left = JOINED.unit["left"].model_copy(update={"ppm": Fraction(seed % 7 * 20)})
    case = JOINED.model_copy(update={"unit": {**JOINED.unit, "left": left}})
    return *run(case, level, kinds, "0.01", programs), [meddler.seen for meddler in meddlers.values()]


JOINED = small.case(
    unit={
        "left": {"firmware": "meddler", "modules": ["SCI-A", "GPIO"]},
        "right": {"firmware": "meddler", "modules": ["SCI-B"]},
    },
    cable=[{"from": "left.SCI-A.TX", "to": "right.SCI-B.RX"}, {"from": "right.SCI-B.TX", "to": "left.SCI-A.RX"}],
)
SCENES = pytest.mark.parametrize("scene", [alone, joined])


@RECORDED
@SCENES
@pytest.mark.parametrize("seed", range(200) if explores() else range(5))
def test_meddling_in_the_middle_of_a_frame_gives_what_edges_give(scene: Any, seed: int, kinds: tuple[Kind, ...]):
    edge, adaptive = scene(seed, "edge", kinds), scene(seed, "adaptive", kinds)
    assert adaptive[2] == edge[2]
    assert adaptive[1] == edge[1]
    assert told(adaptive[0]) == told(edge[0])


@SCENES
@pytest.mark.parametrize("seed", range(100) if explores() else range(2))
def test_firmware_that_only_sends_and_receives_gives_what_edges_give_in_few_events(scene: Any, seed: int):
    edge, adaptive = (scene(seed, level, BUT_PADS, True) for level in ("edge", "adaptive"))
    assert adaptive[2] == edge[2]
    assert adaptive[1] == edge[1]
    assert told(adaptive[0]) == told(edge[0])
    counts = adaptive[0].counts
    assert counts[FRAMES_PASSED] >= 0.9 * counts[FRAMES] > 5


@pytest.mark.parametrize(("name", "frames"), [("uart_logger", 36), ("imu_hil", 36)])
def test_where_nobody_can_tell_every_frame_passes(name: str, frames: int):
    edge, adaptive = (run(load(TIMING / f"{name}.toml"), level, (), "0.05")[0] for level in ("edge", "adaptive"))
    assert adaptive.counts[FRAMES_PASSED] == adaptive.counts[FRAMES] == adaptive.sci_bytes == frames
    assert FRAMES not in edge.counts and told(adaptive) == told(edge)
    assert adaptive.events < edge.events - frames


def test_a_faulty_line_goes_edge_by_edge():
    adaptive = run(load(TIMING / "imu_hil_broken_line.toml"), "adaptive", (), "0.05")[0]
    assert adaptive.counts[FRAMES] > 20 and adaptive.counts[FRAMES_PASSED] == 0


def test_a_line_whose_edges_are_recorded_goes_edge_by_edge_and_the_other_one_passes():
    counts = {}
    for wire in ("left.SCI-A.TX", "right.SCI-B.TX"):
        seen: list[object] = []
        meddlers = {"left": Meddler(1, "SCI-A", True), "right": Meddler(1, "SCI-B", True)}
        programs = {name: Firmware("meddler", meddler, None) for name, meddler in meddlers.items()}
        scene = Scene(
            JOINED.model_copy(update={"fidelity": "adaptive"}),
            lambda recorder, _, to=seen, wire=wire: recorder.subscribe([Kind.EDGE], to.append, {Kind.EDGE: [wire]}),
            programs,
        )
        counts[wire] = scene.run(Fraction("0.01")).counts
        assert len(seen) > 20
    passed = [one[FRAMES_PASSED] for one in counts.values()]
    assert min(passed) > 0 and sum(passed) <= next(iter(counts.values()))[FRAMES]


def test_a_run_that_ends_in_the_middle_of_a_frame_leaves_the_lines_as_they_are():
    case = load(TIMING / "uart_logger.toml")
    for ticks in range(0, 300, 7):
        levels = []
        for level in ("edge", "adaptive"):
            scene = Scene(case.model_copy(update={"fidelity": level}))
            scene.kernel.run_until(scene.start + scene.timebase.ticks(Fraction(2, 1000) + Fraction(ticks, 10**6)))
            levels.append((scene.wires["RX"].level, scene.wires["RX"].held_by()))
        assert levels[0] == levels[1], ticks
