"""State of a scene: its contents, the differences of two states, and runs that continue from a restored state."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

import pytest

from periph_sim import Case, Scene, load, make_case
from periph_sim.core.restore import NotRestorable, restore
from periph_sim.core.snapshot import Absent, Foreign, Made, Snapshot, class_name
from periph_sim.processor.image.counting_loop import CountingLoop
from periph_sim.scene.state import modules_of
from tests.scene import small
from tests.scene.runs import TIMING, recorded
from tests.scene.small import sentence_of

CASES = sorted(path.stem for path in TIMING.glob("*.toml"))
# Images, the number of restored states, and the ms within which they are: 200 states. A wait of the EEPROM takes 5 ms.
IMAGES = {
    "imu_hil_image": (80, 110),
    "variants/image_blink": (20, 12),
    "variants/image_eeprom": (30, 20),
    "variants/image_register_slave": (30, 45),
    "variants/image_rtc": (20, 12),
    "variants/image_sci_echo": (20, 30),
}
INSTANTS_AHEAD = 3  # a restored scene is compared up to the third next instant
BLINK = Path(__file__).parents[2] / "firmware" / "c28x" / "blink.asm"


def case_of(name: str, *changes: str) -> Case:
    return load(TIMING / f"{name}.toml", list(changes))


def ms(scene: Scene, count: float) -> int:
    """Return the tick `count` milliseconds after the start."""
    return scene.start + int(count * scene.timebase.per_second) // 1000


def advanced(case: Case, count: float) -> Scene:
    """Return a scene that has run for `count` milliseconds."""
    scene = Scene(case)
    scene.advance(ms(scene, count))
    return scene


def differing(one: Snapshot, other: Snapshot) -> dict[str, tuple[object, object]]:
    """Return the differences of two states, except times in the past that have no effect any more."""
    return {
        name: pair
        for name, pair in one.differences(other).items()
        if not (name.endswith(("._wake.time", "._next.time")) or Absent() in pair)
    }


# Two runs ------------------------------------------------------------------------


@pytest.mark.parametrize("name", CASES)
def test_two_runs_of_a_case_have_equal_states(name: str):
    case = case_of(name)
    first, second = Scene(case), Scene(case)
    pending: set[object] = set()
    for at in (0, 5.3, 9.1) if name == "imu_hil_c" else (0, 9.1, 21):
        for scene in (first, second):
            scene.advance(ms(scene, at))
        assert first.state().differences(second.state()) == {}
        pending.update(first.state().values["kernel._queue.first"].keys)
    assert pending and len(first.state().values) > 300


@pytest.mark.parametrize("name", ["imu_hil", "eeprom_log", "imu_chips", "two_dsps", "uart_logger", "imu_hil_spikes"])
def test_the_state_does_not_depend_on_when_a_run_begins(name: str):
    """Times count from the current tick. For events that have not occurred they are constant, before the start."""
    states = [advanced(case_of(name, f"start={start}"), 28.3).state() for start in ("0 ms", "7 ms")]
    later = states[1].tick - states[0].tick
    for here, there in states[0].differences(states[1]).values():
        assert here - there == later
        assert here + states[0].tick <= 0


def test_a_changed_byte_is_a_difference_by_name():
    scene = advanced(case_of("imu_hil_image"), 9)
    before, ram = scene.state(), scene.units["dsp"].processor.bus.ram
    was = ram.word(0x412)
    ram.put(0x412, was ^ 0x5A)
    assert before.differences(scene.state()) == {"dsp.processor.bus.ram._low[1042]": (was, was ^ 0x5A)}


def test_taking_a_state_changes_nothing():
    """This also holds in the middle of skipped bits, which are then executed up to the current time."""
    case = case_of("imu_hil_image")
    plain, records = recorded(case)
    observed, observed_records = recorded(case)
    observed.state()
    random = Random(4)
    for at in sorted(random.uniform(0, 31) for _ in range(40)):
        observed.advance(ms(observed, at))
        plain.advance(ms(plain, at))
        observed.state()
    assert len(records) > 2000 and observed_records == records


@pytest.mark.parametrize("name", ["imu_hil", "eeprom_log", "imu_hil_reset"])
def test_the_state_of_a_scene_without_records_does_not_depend_on_earlier_stops(name: str):
    """A stop in the middle of skipped bits divides them, and the state does not depend on that either."""
    straight, stopped = Scene(case_of(name)), Scene(case_of(name))
    for at in (1.0001, 3.0009, 7.0049, 16.0256):
        stopped.advance(ms(stopped, at))
    straight.advance(stopped.kernel.now)
    assert straight.state().differences(stopped.state()) == {}


# Restored scenes -----------------------------------------------------------------


@pytest.mark.parametrize("name", IMAGES)
def test_a_restored_image_continues_from_random_instants_as_before(name: str):
    """The records up to the third instant after the restored one are equal, and so is the state."""
    count, within = IMAGES[name]
    case, random = case_of(name), Random(f"instants of {name}")
    whole, records = recorded(case)
    instants = sorted(random.randrange(ms(whole, within)) for _ in range(count)) + [
        ms(whole, within + n) for n in (1, 2, 3)
    ]
    states, counts = [], []
    for at in instants:
        whole.advance(at)
        states.append(whole.state())
        counts.append(len(records))
    compared = 0
    for place in range(count):
        scene, again = recorded(case)
        scene.restore(states[place])
        before = len(again)
        assert states[place].differences(scene.state()) == {}
        scene.advance(instants[place + INSTANTS_AHEAD])
        assert again[before:] == records[counts[place] : counts[place + INSTANTS_AHEAD]]
        assert differing(states[place + INSTANTS_AHEAD], scene.state()) == {}
        compared += len(again) - before
    assert compared > 20 * count


@pytest.mark.parametrize("name", IMAGES)
def test_no_record_depends_on_undeclared_state(name: str):
    """The state is restored in a scene with another seed and time, in which all undeclared state is different."""
    _, within = IMAGES[name]
    random, moved = Random(f"others of {name}"), 0
    for _ in range(6):
        whole, records = recorded(case_of(name, "seed=1"))
        other, other_records = recorded(case_of(name, "seed=2"))
        at = ms(whole, random.uniform(within / 2, within))
        whole.advance(at)
        other.advance(ms(other, random.uniform(within / 2, within)))
        snapshot = whole.state()
        moved += len(snapshot.differences(other.state()))
        restore(snapshot, modules_of(other))
        before, other_before = len(records), len(other_records)
        for scene in (whole, other):
            scene.advance(at + ms(whole, 25))
        assert other_records[other_before:] == records[before:]
    assert moved > 60


COUNTS_AND_CALLS = """
 .reserve ".stack", 0x400, 0x40
 .sect ".text", 0x9000
_main: MOV SP,#0x400
loop: MOV AL,#200
count: ADDB AL,#-1
 SB count,NEQ
 LCR _work
 SB loop,UNC
_work: LRETR
 .entry _main
"""


def test_an_image_with_a_stack_budget_is_restored_while_a_loop_is_traced(tmp_path: Path):
    (tmp_path / "own.asm").write_text(COUNTS_AND_CALLS)
    budget = '[[budget]]\nname = "stack"\nmeasure = "stack high-water"\nmax = 9\n'
    unit = '[unit.dsp]\nimage = "own.asm"\nmodules = ["GPIO"]\n'
    (tmp_path / "own.toml").write_text(f'name = "own"\nduration = "1 ms"\n{unit}{budget}')
    case = load(tmp_path / "own.toml")
    scene, traced = Scene(case), 0
    cycle = scene.timebase.per_second // 7_500_000
    for at in range(700, 900, 3):
        scene.advance(scene.start + at * cycle)
        state, again = scene.state(), Scene(case)
        again.restore(state)
        assert state.differences(again.state()) == {}
        traced += Made(class_name(CountingLoop)) in state.values.values()
    assert traced


def test_every_image_case_can_be_restored():
    for name in IMAGES:
        scene = advanced(case_of(name), 10)
        foreign = [one for one, value in scene.state().values.items() if isinstance(value, Foreign)]
        assert foreign == []


# Scenes of other firmware, which are run up to the snapshot -----------------------


@pytest.mark.parametrize(
    ("name", "count"), [("imu_hil", 4), ("imu_hil_c", 1), ("eeprom_log", 4), ("two_dsps", 4), ("imu_hil_reset", 4)]
)
def test_restored_firmware_continues_from_random_instants_as_before(name: str, count: int):
    """C sources are restored once and run shorter, since each access is looked up in the sources."""
    case, random = case_of(name), Random(f"instants of {name}")
    whole, records = recorded(case)
    ends_at = ms(whole, 8 + 12 * count if count > 1 else 8)
    instants = sorted(random.randrange(ends_at) for _ in range(count))
    states = []
    for at in instants:
        whole.advance(at)
        states.append((whole.state(), len(records)))
    whole.advance(ends_at)
    assert len(records) > states[0][1]
    for state, before in states:
        scene, again = recorded(case)
        scene.restore(state)
        assert scene.kernel.now == state.tick and again == records[:before]
        scene.advance(ends_at)
        assert again == records


def test_a_snapshot_of_firmware_that_was_edited_is_refused(tmp_path: Path):
    """It is refused even if the edit would take effect only after the snapshot."""
    text = "def main(dsp, settings):\n    dsp.compute(1_000_000)\n    dsp.compute(100)\n"
    source = tmp_path / "mine.py"
    source.write_text(text)
    case = small.case(unit={"dsp": {"firmware": str(source), "modules": ["GPIO"]}})
    snapshot = advanced(case, 1).state()
    Scene(case).restore(snapshot)
    source.write_text(text.replace("100)", "200)"))
    assert refused(Scene(case), snapshot) == "the snapshot was taken of a scene with another program in unit dsp"


@pytest.mark.parametrize("name", ["head", "records", "kernel", "SCL", "dsp.clock", "fault 0", "sampler 1", "head'"])
def test_a_chip_with_the_name_of_another_part_hides_no_state(name: str):
    tables = {
        "unit": {"dsp": {"firmware": "responder", "modules": ["I2C-A"]}},
        "controller": {"order": ["gyroscope"]},
        "chip": {name: {"model": "itg3200", "values": {"fixed": [10, -20, 30]}}},
        "fault": [{"kind": "hold", "wire": "SDA", "at": "1 ms", "length": "1 ms"}],
    }

    def parts(tables: dict[str, Any]) -> list[object]:
        scene = Scene(make_case(name="names", duration="1 ms", **tables))
        return [type(module.target) for module in modules_of(scene).values()]

    assert parts(tables) == parts(tables | {"chip": {"gyroscope": tables["chip"][name]}})


def test_a_state_that_no_run_leads_to_is_refused():
    """The test changes a word of RAM."""
    scene = advanced(case_of("responder"), 2)
    ram = scene.units["dsp"].processor.bus.ram
    ram.put(0x400, ram.word(0x400) ^ 1)
    assert sentence_of(NotRestorable, lambda: Scene(case_of("responder")).restore(scene.state())) == (
        "the scene was run to 2000.000 us, where dsp.processor.bus.ram._low[1024] is 0 instead of 1; "
        "its firmware or a device depends on more than the case, or the snapshot was changed"
    )


# Snapshots that do not fit ---------------------------------------------------------


def refused(scene: Scene, snapshot: Snapshot) -> str:
    """Return the reason why the snapshot is refused, after a check that the scene is unchanged."""
    before = scene.state()
    message = sentence_of(NotRestorable, lambda: scene.restore(snapshot))
    assert before.differences(scene.state()) == {} and before.tick == scene.kernel.now
    return message


@pytest.fixture
def flagship() -> Snapshot:
    return advanced(case_of("imu_hil_image"), 9).state()


def test_a_snapshot_of_another_case_is_refused(flagship: Snapshot):
    scene = Scene(case_of("variants/image_blink"))
    assert refused(scene, flagship) == "the snapshot is of case 'imu_hil_image', and the scene is of case 'image_blink'"


@pytest.mark.parametrize(
    ("change", "what"),
    [("seed=2", "[seed]"), ("controller.rate=400 kHz", "[controller]"), ("unit.dsp.ppm=31", "[unit]")],
)
def test_a_snapshot_of_a_changed_case_is_refused(flagship: Snapshot, change: str, what: str):
    scene = Scene(case_of("imu_hil_image", change))
    assert refused(scene, flagship) == f"the snapshot was taken of a scene with another {what}"


def test_a_snapshot_fits_a_longer_run_with_other_budgets(flagship: Snapshot):
    scene = Scene(case_of("imu_hil_image", "duration=1 s", "budget.0.max=200 us"))
    scene.restore(flagship)
    assert flagship.differences(scene.state()) == {}


def test_a_snapshot_of_another_version_is_refused(flagship: Snapshot):
    strange = flagship._replace(identity=(("version", "0.0.9"), *flagship.identity[1:]))
    message = refused(Scene(case_of("imu_hil_image")), strange)
    assert message == "the snapshot is of version 0.0.9 of periph_sim, and this is version 0.1.0"


def test_a_snapshot_of_another_program_is_refused(tmp_path: Path):
    source = tmp_path / "program.asm"
    case = small.case(unit={"dsp": {"image": str(source), "modules": ["GPIO"]}})
    source.write_text(BLINK.read_text())
    snapshot = Scene(case).state()
    source.write_text(BLINK.read_text().replace("75000", "75300"))
    assert refused(Scene(case), snapshot) == "the snapshot was taken of a scene with another program in unit dsp"


def test_a_snapshot_of_a_scene_with_other_records_is_refused(flagship: Snapshot):
    scene, _ = recorded(case_of("imu_hil_image"))
    assert refused(scene, flagship) == "the snapshot was taken of a scene with another choice of records"


def test_a_scene_that_has_run_cannot_be_restored(flagship: Snapshot):
    scene = advanced(case_of("imu_hil_image"), 1)
    assert refused(scene, flagship).startswith("the scene has run already")


def test_an_object_that_declares_no_state_is_named(flagship: Snapshot):
    values = flagship.values | {"dsp.SCI-A.chip._rx.fifo": Foreign("a.Queue")}
    message = refused(Scene(case_of("imu_hil_image")), flagship._replace(values=values))
    assert message == "dsp.SCI-A.chip._rx.fifo is a a.Queue, which declares no state, so it cannot be restored"
