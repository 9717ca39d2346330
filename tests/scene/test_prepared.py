"""A prepared scene gives the records of a new one: for every key of a case, in any order, and in a new process."""

from __future__ import annotations

import hashlib
import json
import random
import subprocess
import sys
import tomllib
from collections.abc import Callable
from dataclasses import asdict, replace
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from periph_sim import BadCase, BadRecording, Dsp, Firmware, FirmwareError, PreparedScene, Scene, load, make_case, run
from periph_sim.core.examples import EXAMPLES
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.records.recording import Subscribe
from periph_sim.scene.plan import ScenePlan
from tests.scene import schema_keys
from tests.scene.runs import TIMING
from tests.scene.small import sentence_of

LENGTH = Fraction(3, 1000)
ACCEPTED = 200  # minimum number of accepted changes

IMU = """
name = "imu"
duration = "3 ms"
[unit.dsp]
firmware = "imu_hil"
modules = ["I2C-A", "SCI-A", "GPIO", "TIMER0"]
pins = { MODEL = 34 }
[unit.dsp.settings]
arithmetic = "q16"
noise_seed = 1
model_cost = "estimate"
beyond_estimate = "20 us to 40 us"
[unit.dsp.options.i2c]
aas_sdir_point = "fall8"
[controller]
first = "1 ms"
order = ["gyroscope"]
check = "host"
[host]
first = "100 us"
jitter = "50 us"
[host.motion]
kind = "sines"
angles = [{ of = "phi", amplitude = "30 deg", frequency = "0.31 Hz" }]
accelerations = [{ of = "ax", amplitude = "0.1 g", frequency = "0.7 Hz" }]
[[fault]]
kind = "spike"
wire = "SCL"
at = "1.2 ms"
width = "20 ns"
[[budget]]
name = "reaction"
measure = "reaction"
max = "3 us"
[[budget]]
name = "bytes"
measure = "wrong bytes"
max = 0
[[budget]]
name = "pin"
measure = "each time in pin MODEL = 1"
p50 = "300 us"
"""

BUS = """
name = "bus"
duration = "3 ms"
[controller]
first = "100 us"
period = "1 ms"
[[controller.request]]
address = 0x53
pointer = 0
count = 2
[[controller.request]]
address = 0x50
count = 1
[chip.acceleration]
model = "adxl345"
registers = { POWER_CTL = 8 }
[chip.acceleration.values]
fixed = [0.1, 0.2, 0.3]
[device.d]
model = "registers"
address = 0x51
register = [{ name = "DATA", at = 0, reset = 0x5A }]
[device.memory]
model = "24lc64"
address = 0x50
[[budget]]
name = "round"
measure = "round"
max = "900 us"
"""

LINES = """
name = "lines"
duration = "3 ms"
[unit.dsp]
firmware = "echo.py"
modules = ["SCI-A", "GPIO"]
pins = { DE = 12, LED = 13 }
[[transceiver]]
on = "dsp.SCI-A"
de = "DE"
[serial]
baud = 115200
[[serial.send]]
name = "ask"
to = "dsp.SCI-A"
text = "ab"
at = "200 us"
[[serial.expect]]
name = "answer"
from = "dsp.SCI-A"
text = "ab"
after_send = "ask"
within = "900 us"
[watch.led]
kind = "blink"
wire = "LED"
rate = "2 kHz"
duty = "50 %"
tolerance = "5 us"
"""

IMAGE = """
name = "image"
duration = "3 ms"
[unit.dsp]
image = "BLINK"
modules = ["GPIO", "TIMER0"]
pins = { LED = 31 }
[[unit.dsp.stub]]
register = "ADC.ADCST"
value = 1
[[cable]]
from = "dsp.GPIO31"
to = "dsp.GPIO1"
[[budget]]
name = "pin"
measure = "period of edge LED rise"
max = "1 ms"
"""

ROUNDS = """
name = "rounds"
duration = "3 ms"
[unit.master]
firmware = "eeprom_log"
modules = ["I2C-A", "TIMER0"]
[device.memory]
model = "24lc64"
address = 0x50
[rounds]
period = "10 ms"
[[rounds.request]]
name = "read"
address = 0x50
count = 1
"""

ECHO = '''
"""Sends back what it receives, and counts its runs where a module that is not fresh would keep the count."""

from dataclasses import dataclass

from periph_sim.firmware import sci_fifo_receiver, start_pin

RUNS = []


@dataclass
class Settings:
    extra: int = 0


def main(dsp, settings):
    RUNS.append(settings)
    start_pin(dsp, 12)
    start_pin(dsp, 13)
    sci_fifo_receiver(dsp, 40, 1)
    sci = dsp.module("SCI-A")
    dsp.compute(1000 * len(RUNS) + settings.extra)
    while True:
        dsp.set_pin(13)
        dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0, timeout=30_000)
        if sci.SCIFFRX.RXFFST:
            word = sci.SCIRXBUF.all & 0xFF
            dsp.set_pin(12)
            sci.SCITXBUF.all = word
            dsp.spin(lambda: sci.SCICTL2.TXEMPTY == 1)
            dsp.clear_pin(12)
        dsp.clear_pin(13)
        dsp.compute(30_000)
'''
BLINK = EXAMPLES / "firmware" / "c28x" / "blink.asm"
FILES = {"imu": IMU, "bus": BUS, "lines": LINES, "image": IMAGE.replace("BLINK", str(BLINK)), "rounds": ROUNDS}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_files(tmp_path_factory.mktemp("prepared"))


def write_files(folder: Path) -> Path:
    for name, text in FILES.items():
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    (folder / "echo.py").write_text(ECHO, encoding="utf-8")
    return folder


class Digest:
    """Digest of the records of a run, as text."""

    def __init__(self) -> None:
        self._hash = hashlib.sha256()
        self.records = 0

    def subscribe(self, recorder: Recorder, timebase: Timebase) -> None:
        self._hash.update(str(timebase.per_second).encode())
        recorder.subscribe(Kind, self._add)

    def _add(self, record: Record) -> None:
        self.records += 1
        self._hash.update(repr(record).encode())

    @property
    def text(self) -> str:
        return f"{self.records} {self._hash.hexdigest()[:24]}"


def outcome(build: Callable[[Subscribe], Scene], length: Fraction = LENGTH) -> str:
    """Return all results of a run as text, or the reason why the case is refused."""
    digest = Digest()
    try:
        scene = build(digest.subscribe)
        result = scene.run(length)
    except (BadCase, FirmwareError) as error:
        return f"{type(error).__name__}: {error}"
    shown = {key: value for key, value in asdict(result).items() if key != "wall_s"}
    return f"{digest.text} {json.dumps(shown, default=str)}"


def loaded(file: Path, changes: list[str], subscribe: Subscribe) -> Scene:
    return Scene(load(file, changes), subscribe)


def drawn_changes() -> dict[str, list[tuple[str, str]]]:
    """Return changes of each key by the table at the top of the case, as (name of a case, change)."""
    rng = random.Random(8)
    found: dict[str, list[tuple[str, str]]] = {}
    trees = {name: tomllib.loads(text) for name, text in FILES.items()}
    for path, alternatives in schema_keys.keys().items():
        top = path.partition(".")[0]
        having = [name for name, tree in trees.items() if top in tree] or ["imu"]
        name = rng.choice(having)
        value = rng.choice(schema_keys.values(alternatives) or ["1"])
        found.setdefault(top, []).append((name, f"{_named(path, trees[name])}={value}"))
    return found


def _named(path: str, tree: Any) -> str:
    """Return the path with a name from the case in place of each name that a user gives."""
    parts = []
    for part in path.split("."):
        if part == schema_keys.NAMED:
            part = next(iter(tree), "some") if isinstance(tree, dict) else "some"
        parts.append(part)
        if isinstance(tree, dict):
            tree = tree.get(part)
        else:
            tree = tree[0] if isinstance(tree, list) and tree else None
    return ".".join(parts)


CHANGES = drawn_changes()


@pytest.fixture(scope="module")
def prepared(folder: Path) -> dict[str, PreparedScene]:
    """One object for all changes of a case, so that each change follows many others."""
    found = {name: PreparedScene(folder / f"{name}.toml") for name in FILES}
    for one in found.values():
        one.scene()
    return found


@pytest.mark.parametrize("top", CHANGES)
def test_a_changed_key_gives_the_records_of_a_fresh_load(
    top: str, folder: Path, prepared: dict[str, PreparedScene]
) -> None:
    for name, change in CHANGES[top]:
        fresh = outcome(partial(loaded, folder / f"{name}.toml", [change]))
        assert outcome(partial(prepared[name].scene, [change])) == fresh, (name, change)


def test_most_changes_are_accepted(folder: Path) -> None:
    accepted = 0
    for name, change in (one for some in CHANGES.values() for one in some):
        try:
            load(folder / f"{name}.toml", [change])
            accepted += 1
        except BadCase:
            pass
    assert accepted > ACCEPTED


@pytest.mark.parametrize("name", FILES)
def test_the_cases_have_records(name: str, prepared: dict[str, PreparedScene]) -> None:
    assert int(outcome(partial(prepared[name].scene, ())).split()[0]) > 25


# Runs in any order --------------------------------------------------------------

RUNS: list[tuple[str, list[str]]] = [
    ("imu", []),
    ("imu", ["seed=7", "controller.jitter=100 us"]),
    ("imu", ["unit.dsp.settings.noise_seed=3", "host.jitter=90 us"]),
    ("imu", ["unit.dsp.settings.arithmetic=float64", "controller.period=2 ms"]),
    ("bus", []),
    ("bus", ["controller.request.0.count=1", "start=1 s"]),
    ("lines", []),
    ("lines", ["unit.dsp.settings.extra=50"]),
    ("image", []),
    ("rounds", ["device.memory.write_time=1 ms to 2 ms"]),
]
COUNT = 100


def outcomes(folder: Path, seed: int, count: int) -> dict[str, list[str]]:
    """Return the results of runs of prepared scenes, by run, in an order drawn from a seed."""
    prepared = {name: PreparedScene(folder / f"{name}.toml") for name in FILES}
    order = [RUNS[number % len(RUNS)] for number in range(count)]
    random.Random(seed).shuffle(order)
    found: dict[str, list[str]] = {}
    for name, changes in order:
        came = outcome(partial(prepared[name].scene, changes))
        found.setdefault(f"{name} {changes}", []).append(hashlib.sha256(came.encode()).hexdigest())
    return found


def in_a_process(folder: Path, seed: int, count: int) -> dict[str, list[str]]:
    code = (
        f"from tests.scene.test_prepared import *; print(json.dumps(outcomes(Path({str(folder)!r}), {seed}, {count})))"
    )
    root = Path(__file__).parents[2]
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True)
    return dict(json.loads(done.stdout))


def test_a_hundred_runs_in_shuffled_order_equal_those_of_fresh_processes(folder: Path) -> None:
    here = outcomes(folder, 1, COUNT)
    assert sum(map(len, here.values())) == COUNT and len(here) == len(RUNS)
    assert all(len(set(same)) == 1 for same in here.values())
    assert len({same[0] for same in here.values()}) == len(RUNS)  # the runs differ
    for seed in (2, 3):
        fresh = in_a_process(folder, seed, len(RUNS))  # each run once, with another one first
        assert {name: same[0] for name, same in fresh.items()} == {name: same[0] for name, same in here.items()}


# Arguments ------------------------------------------------------------------------


def test_run_returns_what_a_run_of_the_file_returns(folder: Path) -> None:
    file = folder / "imu.toml"
    prepared = PreparedScene(file)
    for changes in ([], ["seed=5"], []):
        one, other = prepared.run(changes, seconds="2 ms"), run(file, changes, seconds="2 ms")
        assert replace(one, wall_s=0) == replace(other, wall_s=0)


def test_firmware_is_given_as_a_function_or_as_loaded_firmware() -> None:
    prepared, ran = PreparedScene(TIMING / "responder.toml"), []

    def firmware(dsp: Dsp, settings: object) -> None:
        ran.append(settings)

    for program in (firmware, Firmware("mine", firmware, None)):
        assert prepared.run(seconds="1 ms", programs={"dsp": program}).case == "responder"
    assert ran == [None, None]


def test_changes_of_all_runs_are_applied_before_those_of_one_run(folder: Path) -> None:
    prepared = PreparedScene(folder / "imu.toml", ["name=a", "seed=3"])
    assert prepared.run(seconds="1 us").case == "a" and prepared.run(["name=b"], seconds="1 us").case == "b"
    assert prepared.plan(["name=b"]).case.seed == 3


def test_a_case_from_make_case_is_prepared_in_its_current_state(folder: Path) -> None:
    case = make_case(**tomllib.loads(IMU))
    prepared = PreparedScene(case)
    before = outcome(partial(prepared.scene, ()))
    case.unit["dsp"].settings["beyond_estimate"] = "200 us"
    assert outcome(partial(prepared.scene, ())) == before != outcome(partial(Scene, case))
    with pytest.raises(BadCase, match="changes go with a file"):
        prepared.run(["seed=2"])


def test_a_run_that_is_recorded_has_the_records_of_the_file(folder: Path, tmp_path: Path) -> None:
    prepared = PreparedScene(folder / "imu.toml")
    prepared.run(["seed=5"], record=tmp_path / "a.jsonl")
    run(folder / "imu.toml", ["seed=5"], record=tmp_path / "b.jsonl")
    assert (tmp_path / "a.jsonl").read_bytes() == (tmp_path / "b.jsonl").read_bytes()
    with pytest.raises(BadRecording, match="imu"):
        prepared.run(record=folder / "imu.toml")


def test_the_file_is_read_once_and_its_firmware_in_each_run(folder: Path, tmp_path: Path) -> None:
    write_files(tmp_path)
    prepared = PreparedScene(tmp_path / "lines.toml")
    before = outcome(partial(prepared.scene, ()))
    (tmp_path / "lines.toml").unlink()
    assert outcome(partial(prepared.scene, ())) == before
    (tmp_path / "echo.py").write_text(ECHO.replace("compute(1000", "compute(2000"), encoding="utf-8")
    assert outcome(partial(prepared.scene, ())) != before


def test_an_incomplete_case_can_be_completed_by_a_change(tmp_path: Path) -> None:
    file = tmp_path / "part.toml"
    file.write_text(IMU.replace('duration = "3 ms"', ""), encoding="utf-8")
    prepared = PreparedScene(file)
    assert prepared.run(["duration=1 ms"]).simulated_s == 0.001
    with pytest.raises(BadCase, match="duration"):
        prepared.run()
    with pytest.raises(BadCase, match="duration"):
        prepared.run(["seed=3"])


# The plan -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "same"),
    [("seed=3", True), ("host.jitter=1 us", True), ("unit.dsp.pins.LED=12", False), ("budget=[]", False)],
)
def test_plans_of_budgets_are_reused_if_the_change_does_not_affect_them(folder: Path, change: str, same: bool) -> None:
    prepared = PreparedScene(folder / "imu.toml")
    prepared.scene([change])
    assert (prepared.plan([change]).limits is prepared.plan().limits) == same


def test_only_the_latest_plans_are_kept(folder: Path) -> None:
    prepared = PreparedScene(folder / "imu.toml")
    plans = [prepared.plan([f"seed={seed}"]) for seed in range(40)]
    assert prepared.plan(["seed=39"]) is plans[39] and prepared.plan(["seed=24"]) is plans[24]
    assert prepared.plan(["seed=0"]) is not plans[0]


@pytest.mark.parametrize("change", ["controller.first=20000 d", "host.silent=[['1 s', '20000 d']]"])
def test_a_time_that_is_too_long_is_reported_with_its_line(folder: Path, change: str) -> None:
    fresh = sentence_of(BadCase, lambda: Scene(load(folder / "imu.toml", [change])))
    assert sentence_of(BadCase, lambda: PreparedScene(folder / "imu.toml").scene([change])) == fresh
    assert change.partition("=")[0] in fresh


def test_a_scene_may_be_built_from_a_temporary_plan() -> None:
    plan = ScenePlan(make_case(**tomllib.loads(IMU)))
    assert outcome(partial(Scene, plan)) == outcome(partial(Scene, plan.case))
