"""Sensor chips on a scene's bus: their tables in a case, set-up and reads by a sensor head, and mistakes."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from periph_sim import BadCase, Scene, load
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.imu.sensors import SENSORS as CHIPS
from tests.scene.runs import TIMING, run_case, run_file
from tests.scene.small import case, sentence_of

GYRO = {"model": "itg3200", "values": {"fixed": [10, -20, 30]}}
ACCEL = {"model": "adxl345", "values": {"fixed": [0.25, -0.5, 1]}, "registers": {"POWER_CTL": 8}}
MAG = {"model": "hmc5883l", "values": {"fixed": [0.1, 0.2, 0.3]}, "registers": {"Mode": 0}}
THREE = {"gyroscope": GYRO, "accelerometer": ACCEL, "magnetometer": MAG}
ORDER = ["gyroscope", "accelerometer", "magnetometer"]


def counts(run: Any) -> list[tuple[int, ...]]:
    """Return the values x, y, z of each request of the last round."""
    return [CHIPS[t.name].values(bytes(t.phases[-1].got)) for t in run.rounds[-1]]


def test_the_shipped_case_passes():
    run = run_file("real_chips", "0.5")
    assert run.broken() == [] and run.result.verdict == "pass"
    assert run.result.notes == [] and run.result.unknowns == []


def test_a_scene_with_chips_needs_no_unit_and_builds_none():
    run = run_case(case(chip=THREE, controller={"order": ORDER}), "0.05")
    assert run.scene.units == {} and set(run.scene.wires) == {"SDA", "SCL"} and set(run.scene.chips) == set(THREE)
    assert run.answered() == ["GAM"] * 3
    assert counts(run) == [(144, -288, 431), (64, -128, 256), (109, 218, 327)]


def test_chips_that_are_not_addressed_cost_no_events():
    assert Scene(case(chip=THREE)).run(Fraction(3600)).events == 0


def test_a_register_that_the_case_sets_gives_its_note_without_a_transfer():
    asleep = ACCEL | {"registers": {"POWER_CTL": 0x18}}
    (note,) = Scene(case(chip={"accelerometer": asleep})).run(Fraction(1, 1000)).notes
    assert "AUTO_SLEEP is set; this model never enters sleep by itself" in note


def test_the_events_of_a_round_of_three_chips():
    """The number of events is a guard on speed: 27 bytes on the wires, each a step of seven bits and two clocks."""
    rounds = [Scene(case("1 s", chip=THREE, controller={"order": ORDER, "rounds": n})).run().events for n in (10, 20)]
    assert rounds[1] - rounds[0] == 10 * 237


def test_a_unit_and_a_chip_share_the_bus():
    unit = {"dsp": {"firmware": "imu_hil", "modules": ["I2C-A"]}}
    two = {"accelerometer": ACCEL, "magnetometer": MAG}
    run = run_case(case(unit=unit, chip=two, controller={"order": ["accelerometer", "gyroscope"]}), "0.02")
    assert run.answered()[0] == "AG", "the emulator waits as the gyroscope; the accelerometer is a chip"
    assert counts(run)[0] == (64, -128, 256)


def test_the_head_sets_the_chips_up_before_the_first_round():
    controller = {"order": ORDER, "first": "60 ms", "initialise": "50 ms", "pointer_by": "STOP"}
    chips = {name: {**chip, "registers": {}} for name, chip in THREE.items()}
    run = run_case(case("100 ms", chip=chips, controller=controller), "0.1")
    startup = [t for t in run.transfers if t.phases[0].start_at < 60_000_000]
    names = ["gyroscope", "accelerometer", "magnetometer"]
    expected = [f"{n} {what}" for n in names for what in ["identification"] * 2 + ["set-up"] * 3]
    assert [t.name for t in startup] == expected and all(t.acked for t in startup)
    read = [phase for t in startup for phase in t.phases if phase.read]
    assert [phase.got.hex() for phase in read] == ["68", "e5", "483433"]
    assert all(phase.got == phase.expect for phase in read)
    assert startup[0].phases[0].start_at == 10_000_000
    assert run.result.counts["rounds"] == 2 and run.answered() == ["GGAAMM"] * 2
    chip = run.scene.chips["magnetometer"].chip
    assert [chip.get(name) for name in ("CRA", "CRB", "Mode")] == [0x18, 0x60, 0x00]


def test_a_round_that_is_due_while_the_chips_are_set_up_is_missed():
    run = run_case(case(chip=THREE, controller={"order": ORDER, "initialise": "1 ms"}), "0.05")
    assert (run.result.counts["missed"], run.result.counts["rounds"]) == (1, 2)


def test_events_of_the_start_up_are_in_no_round():
    budget = {"name": "b", "measure": "from bus START to bus STOP, same round", "max": "1 s"}
    controller = {"order": ORDER, "first": "60 ms", "initialise": "50 ms"}
    run = run_case(case("100 ms", chip=THREE, controller=controller, budget=[budget]), "0.1")
    assert len(run.transfers) == 12 + 2 * 3
    (verdict,) = run.result.budgets
    assert verdict.count == 2 * 3


@pytest.mark.parametrize("values", [{"rows": [["0 s", 1, 0, 0], ["30 ms", 2, 0, 0]]}, {"ramp": "angles"}])
def test_values_change_while_it_runs(values: dict[str, Any]):
    chip = {**GYRO, "values": values}
    run = run_case(case(chip={"gyroscope": chip}, controller={"order": ["gyroscope"]}), "0.1")
    x = [CHIPS["gyroscope"].values(bytes(t.phases[-1].got))[0] for (t,) in run.rounds]
    assert x == ([14, 14, 29, 29, 29] if "rows" in values else [0, 1, 2, 3, 4])


def test_a_ramp_begins_at_its_first_time_after_the_start_of_the_run():
    """Rounds are at 5, 25, 45, 65 and 85 ms; before the first step the values are those of number 0."""
    chip = {**GYRO, "values": {"ramp": "angles", "first": "50 ms"}}
    for start in ("0 s", "1 s"):
        run = run_case(case(chip={"gyroscope": chip}, controller={"order": ["gyroscope"]}, start=start), "0.1")
        assert [CHIPS["gyroscope"].values(bytes(t.phases[-1].got))[0] for (t,) in run.rounds] == [0, 0, 0, 1, 2]


def test_values_in_lsb_are_those_of_the_scale_that_registers_set():
    chip = {**MAG, "registers": {"CRB": 0x60, "Mode": 0}, "values": {"fixed": [1, -2, 3], "unit": "LSB"}}
    assert counts(run_case(case(chip={"m": chip}, controller={"order": ["magnetometer"]}), "0.03")) == [(1, -2, 3)]


def test_a_source_given_as_a_function_replaces_the_values():
    scene = Scene(case(chip={"gyroscope": GYRO}), sources={"gyroscope": lambda tick: (Fraction(1), 0, 0)})
    assert scene.chips["gyroscope"].chip.source(0) == (1, 0, 0)


def test_the_run_does_not_depend_on_the_clock_at_its_start():
    values = {"rows": [["0 s", 1, 0, 0], ["30 ms", 2, 0, 0]]}
    chips = {**THREE, "gyroscope": {**GYRO, "values": values}}
    runs = [run_case(case(chip=chips, controller={"order": ORDER}, start=start), "0.1") for start in ("0 s", "9 d")]
    assert runs[0].read() == runs[1].read() and runs[0].result.events == runs[1].result.events


@pytest.mark.parametrize(("powered", "answered"), [("0 s", "-AM"), ("20 ms", "GAM")])
def test_a_chip_that_is_just_powered_up_does_not_answer_yet(powered: str, answered: str):
    chips = {**THREE, "gyroscope": {**GYRO, "powered": powered}}
    assert run_case(case(chip=chips, controller={"order": ORDER}), "0.01").answered() == [answered]


@pytest.mark.parametrize("delay", ["100 ns", "3 us"])
def test_the_output_delay_is_what_the_case_says(delay: str):
    chip = {**GYRO, "output_delay": delay}
    run = run_case(case(chip={"gyroscope": chip}, controller={"order": ["gyroscope"]}), "0.03")
    assert run.answered() == ["G", "G"] and counts(run) == [(144, -288, 431)]


def test_a_note_is_listed_once_with_its_count_and_recorded_each_time():
    kept: list[Record] = []

    def subscribe(recorder: Recorder, timebase: Timebase) -> None:
        recorder.subscribe([Kind.NOTE], kept.append)

    request = {"address": 0x68, "pointer": 0x16, "count": 0, "write": "00"}
    run = run_case(case(chip={"g": GYRO}, controller={"request": [request]}), "0.05", subscribe)
    assert run.result.notes == [
        "g, first at 5265.000 us: FS_SEL = 0 is reserved; 3 is the full scale [ITG-3200 rev 1.4 DLPF_FS] (3 times)"
    ]
    assert [(record.where, record.what, record.value) for record in kept] == [("g", "duty", n) for n in (1, 2, 3)]


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        (
            ["chip.gyroscope.address=0x53"],
            "chip.gyroscope.address: itg3200 has no address 0x53; it can have 0x68 or 0x69",
        ),
        (
            ["chip.gyroscope.model=adxl345"],
            "chip.accelerometer.address: gyroscope has the address 0x53 too",
        ),
        (
            ["chip.magnetometer.registers.Mod=0"],
            "chip.magnetometer.registers.Mod: hmc5883l has no register 'Mod'; did you mean Mode?",
        ),
        (
            ["chip.magnetometer.options.idle_cod=2"],
            "chip.magnetometer.options.idle_cod: there is no option 'idle_cod'; did you mean idle_code?",
        ),
        (["chip.gyroscope.values.rows=[['1 s', 0, 0, 0]]"], "values need one of fixed, rows and ramp"),
        (["chip.gyroscope.values.first='1 s'"], "first and period belong to ramp"),
        (["chip.gyroscope.model=mpu6050"], "there is no chip 'mpu6050'; it has adxl345, hmc5883l, itg3200"),
        (["chip.gyroscope.modell=itg3200"], "there is no key 'chip.gyroscope.modell'; did you mean model?"),
        (["chip.gyroscope.values.fixd=[1,2,3]"], "there is no key 'chip.gyroscope.values.fixd'; did you mean fixed?"),
        (["chip.gyroscope.values.fixed=[1,nan,3]"], "is not a number"),
        (["chip.gyroscope.values.fixed=[1,2]"], "chip.gyroscope.values.fixed"),
        (["controller.initialise=200 ms"], "initialise is longer than first"),
        (["chip.gyroscope.output_delay=0 s"], "it must be longer than 0"),
    ],
)
def test_mistakes_in_the_tables_of_chips_are_refused(changes: list[str], sentence: str):
    text = sentence_of(BadCase, lambda: Scene(load(TIMING / "real_chips.toml", changes)))
    assert sentence in text and "real_chips.toml" in text


@pytest.mark.parametrize("name", ["dsp", "controller", "host", "serial", "outside"])
def test_a_chip_cannot_have_the_name_of_another_party(name: str):
    unit = {"dsp": {"firmware": "imu_hil", "modules": ["I2C-A"]}}
    with pytest.raises(BadCase, match="another party on the wires already"):
        Scene(case(unit=unit, chip={name: GYRO}))


def test_open_questions_that_mattered_are_listed():
    run = run_case(case(chip={"g": GYRO}, controller={"order": ["gyroscope"]}), "0.01")
    assert run.result.unknowns == ["g.fs_sel_other"], "FS_SEL was not set"


def test_rows_out_of_order_are_refused():
    chip = {**GYRO, "values": {"rows": [["1 s", 0, 0, 0], ["1 s", 0, 0, 0]]}}
    with pytest.raises(BadCase, match=r"chip\.g\.values: the times of the rows must rise from row to row"):
        Scene(case(chip={"g": chip}))


def test_a_head_without_known_chips_cannot_initialise_any():
    controller = {"request": [{"address": 0x10}], "initialise": "1 ms"}
    with pytest.raises(BadCase, match="no known chip is asked"):
        Scene(case(controller=controller))


def test_registers_of_a_chip_that_was_without_power_are_reset():
    off = {"kind": "off", "after": "2 ms", "until": "3 ms"}
    chips = {
        name: {
            "model": "itg3200",
            "address": address,
            "values": {"fixed": [0, 0, 0]},
            "registers": {"SMPLRT_DIV": 9},
            **more,
        }
        for name, address, more in (("kept", 0x68, {}), ("lost", 0x69, {"fault": [off]}))
    }
    scene = Scene(case(chip=chips))
    scene.run(Fraction(5, 1000))
    assert [scene.chips[name].chip.get("SMPLRT_DIV") for name in chips] == [9, 0]
