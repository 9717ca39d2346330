"""Restoring a snapshot re-executes C sources from a log of their accesses."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from random import Random

import pytest

from periph_sim.core.records import RECORDED, Record
from periph_sim.core.restore import NotRestorable
from periph_sim.core.snapshot import Snapshot
from periph_sim.processor.image_files.assemble import SHIPPED
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from periph_sim.scene.scene import Scene
from tests.processor.host_code.test_sources import HERE, MAIN
from tests.scene.runs import TIMING

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc, which compiles C sources, is not installed")

HOST = """\
name = "echo"
duration = "8 ms"

[unit.dsp]
sources = ["echo.c"]
modules = ["SCI-A", "GPIO"]

[unit.dsp.compile]
include = ["."]

[host]
baud = 115200
first = "6 ms"
period = "20 ms"
"""
OTHER_UNITS = f"""
[unit.other]
sources = ["echo.c"]
modules = ["GPIO"]
compile = {{ include = ["."] }}

[unit.image]
image = "{SHIPPED / "blink.asm"}"
modules = ["GPIO"]
"""
ADC = "extern volatile struct { Uint16 word[32]; } AdcRegs;\n"  # not modelled, so it keeps what is written
SET_UP = "EALLOW; SysCtrlRegs.WDCR = 0x68; GpioCtrlRegs.GPADIR = 0x80000000; EDIS; "


@pytest.fixture
def echo(tmp_path: Path) -> Callable[..., Case]:
    """Return a function that makes a case of echo.c, or of a main with the given body."""
    (tmp_path / "device.h").write_text((HERE / "device.h").read_text() + ADC)

    def case(body: str = "", text: str = HOST) -> Case:
        (tmp_path / "echo.c").write_text(MAIN.format(body) if body else (HERE / "echo.c").read_text())
        (tmp_path / "echo.toml").write_text(text)
        return load(tmp_path / "echo.toml")

    return case


def recorded(case: Case) -> tuple[Scene, list[Record]]:
    records: list[Record] = []
    return Scene(case, lambda recorder, _: recorder.subscribe(RECORDED, records.append), restorable=True), records


def us(scene: Scene, count: float) -> int:
    return scene.start + int(count * scene.timebase.per_second) // 1_000_000


def states_at(scene: Scene, instants: list[int]) -> list[Snapshot]:
    states = []
    for at in instants:
        scene.advance(at)
        states.append(scene.state())
    return states


def goes_on(case: Case, state: Snapshot, until: int, records: list[Record]) -> Scene:
    """Restore a state, run on, and compare the records; those between the checkpoint and the state are made again."""
    scene, again = recorded(case)
    again.clear()  # records of the construction
    scene.restore(state)
    assert state.differences(scene.state()) == {} and scene.kernel.now == state.tick
    assert state.base is not None
    scene.advance(until)
    assert again == [one for one in records if one.number > state.base.number and one.tick <= until] != []
    return scene


@pytest.mark.parametrize(("count", "ahead"), [(1, 400), pytest.param(10, 200, marks=pytest.mark.long)])
def test_the_emulator_continues_equally_from_snapshots_at_random_instants(count: int, ahead: int):
    case, random = load(TIMING / "imu_hil_c.toml"), Random(1)
    whole, records = recorded(case)
    states = states_at(whole, sorted(us(whole, random.uniform(150, 7300)) for _ in range(count)))
    whole.advance(us(whole, 7700))
    for state in states:
        goes_on(case, state, state.tick + us(whole, ahead) - whole.start, records)


@pytest.mark.long
def test_snapshots_in_and_near_a_service_routine_can_be_restored(echo: Callable[..., Case]):
    """Main is in an empty loop; the snapshots are just before, in and after the first service routine."""
    case = echo()
    whole, records = recorded(case)
    whole.advance(us(whole, 7000))
    enters, leaves, *others = [one.tick for one in records if one.what == "SCIRXINTA"]
    assert len(others) == 20
    searched, _ = recorded(case)
    window = us(whole, 100) - whole.start
    instants = [enters + (leaves - enters) * part // 40 + window for part in range(-5, 45)]
    for number, state in enumerate(states_at(searched, instants)):
        assert state.base is not None and not enters <= state.base.tick < leaves
        if number % 12 == 0:
            scene = goes_on(case, state, us(whole, 7000), records)
            assert scene.units["dsp"].sources.run.log == whole.units["dsp"].sources.run.log


@pytest.mark.long
def test_snapshots_of_a_restored_scene_can_be_restored(echo: Callable[..., Case]):
    """This also holds twice, after the first scene has run on, and with two units of C sources and one of an image."""
    case = echo(text=HOST + OTHER_UNITS)
    whole, records = recorded(case)
    (early,) = states_at(whole, [us(whole, 6100)])
    whole.advance(us(whole, 7000))
    again = goes_on(case, early, us(whole, 6200), records)
    (late,) = states_at(again, [us(whole, 6250)])
    assert late.base is not None and late.base.tick > early.tick
    for state in (late, late, early):
        goes_on(case, state, us(whole, 7000), records)


def test_after_a_reset_the_log_begins_again(echo: Callable[..., Case]):
    """The watchdog resets the unit after its first 4.4 ms."""
    case = echo("for (;;) GpioDataRegs.GPATOGGLE.all = ++AdcRegs.word[3];")
    whole, records = recorded(case)
    states = states_at(whole, [us(whole, at) for at in (2000, 7000)])
    whole.advance(us(whole, 7500))
    assert whole.units["dsp"].resets
    for state in states:
        goes_on(case, state, us(whole, 7500), records)


def test_without_a_log_the_scene_runs_to_the_snapshot(echo: Callable[..., Case]):
    """This also holds for a snapshot of a scene that has a log."""
    case = echo()
    whole, _ = recorded(case)
    (state,) = states_at(whole, [us(whole, 6100)])
    plain = Scene(case)
    plain.advance(state.tick)
    assert plain.checkpoint is None and plain.state().base is None
    scene = Scene(case, lambda recorder, _: recorder.subscribe(RECORDED, lambda record: None))
    scene.restore(state)
    assert state.differences(scene.state()) == {}


# Snapshots that are refused ----------------------------------------------------------


def refused(case: Case, state: Snapshot) -> str:
    """Return the message of the refused snapshot, which must change nothing: the scene then runs as a new one."""
    scene, records = recorded(case)
    before = scene.state()
    with pytest.raises(NotRestorable) as error:
        scene.restore(state)
    assert before.differences(scene.state()) == {} and before.tick == scene.kernel.now and not records
    new, expected = recorded(case)
    for one in (scene, new):
        one.advance(us(one, 100))
    assert records == expected != []
    assert "\n" not in str(error.value)
    return str(error.value)


def test_a_snapshot_of_another_build_is_refused(echo: Callable[..., Case]):
    whole, _ = recorded(echo())
    (state,) = states_at(whole, [us(whole, 6100)])
    shorter = (HERE / "device.h").read_text().replace('asm(" EDIS")', 'asm(" nop")')
    case = echo()
    (Path(case.unit["dsp"].sources[0]).parent / "device.h").write_text(shorter)
    assert refused(case, state) == "the snapshot was taken of a scene with another program in unit dsp"


DEPENDS = "; what they do depends on more than their accesses, for example on time(), rand() or a file of the host"


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        (
            "GpioDataRegs.GPASET.all = again; ",
            ", access 6 at main:2 of echo.c: the C sources write 0x1 to GPIO.GPASET, but before the snapshot they "
            "write 0x0 to GPIO.GPASET" + DEPENDS,
        ),
        (
            "if (again) for (;;); ",
            ", access 6 at main:2 of echo.c: the C sources compute for 1000000 cycles, but before the snapshot they "
            "compute for 6 cycles" + DEPENDS,
        ),
        (
            "for (int i = 0; i < 9; i++) { SysCtrlRegs.PLLSTS.all; if (i == 5 && again) again = 2; }",
            ", access 18 at main:2 of echo.c: the C sources compute for 30 cycles, but before the snapshot they "
            "compute for 24 cycles" + DEPENDS,
        ),
        (
            "if (again) SysCtrlRegs.LOSPCP; ",
            ", access 7 at main:2 of echo.c: the C sources read SYS.LOSPCP, but before the snapshot they "
            "read SYS.PLLSTS" + DEPENDS,
        ),
        ("int x = 1; if (again) return 0; do x--; while (x); ", ": main ended, which it did not before the snapshot"),
        ("if (again) *(int *)0 = 1; ", ": Segmentation fault at main:2, the host's address 0x0"),
    ],
)
def test_sources_that_behave_differently_the_second_time_are_refused(
    echo: Callable[..., Case], body: str, sentence: str
):
    """The sources know by an environment variable that they run a second time."""
    name = "PERIPH_SIM_TEST_SECOND_RUN"
    first = "char *getenv(const char *); int setenv(const char *, const char *, int); "
    again = f'int again = getenv("{name}") != 0; setenv("{name}", "1", 1); '
    case = echo(first + again + SET_UP + body + "for (;;) SysCtrlRegs.PLLSTS.all;")
    try:
        whole, _ = recorded(case)
        (state,) = states_at(whole, [us(whole, 200)])
        assert refused(case, state).startswith("dsp" + sentence)
    finally:
        os.unsetenv(name)
