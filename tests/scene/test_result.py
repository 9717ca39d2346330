"""The result of a run: stuck lines, notes, counts and verdicts."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim import Dsp, Result, Scene, load
from periph_sim.core.chip import Note
from periph_sim.firmware import sci_fifo_receiver, start_sci
from tests.scene.runs import TIMING
from tests.scene.serial.programs import scene
from tests.scene.small import case, scene_with, unit

STUCK = {"name": "stuck", "measure": "stuck", "max": 5}


def test_ten_sentences_of_stuck_lines_are_shown_and_all_are_counted():
    scene = Scene(case(chip={"gyroscope": {"model": "itg3200", "values": {"fixed": [10, -20, 30]}}}))
    scene.stuck.sentences += [f"SDA is held low, {n}" for n in range(12)]
    result = scene.run(Fraction(0))
    assert result.stuck == scene.stuck.sentences[:10] and result.counts["stuck"] == 12


def result(counts: dict[str, int]) -> Result:
    return Result("x", "pass", 1.0, 1.0, 0, 0, 0, [], counts, [], [], [])


def test_values_that_are_not_given_are_empty():
    plain = result({})
    assert (plain.wrong, plain.first_wrong, plain.estimated, plain.sci_bytes_sent) == ({}, "", [], 0)


def breaks_duties(dsp: Dsp) -> None:
    dsp.eallow()
    dsp.module("SYS").PCLKCR0.all = 0x410
    dsp.edis()
    dsp.compute(1000)
    i2c = dsp.module("I2C-A")
    i2c.I2CPSC.all = 5  # 25 MHz
    i2c.I2CMDR.IRS = 1
    dsp.report_overflow("a product")


def test_times_of_notes_count_from_the_start_of_the_run():
    """The notes are on a duty of a module and of a device, an overflow, the end of main, and a line held low."""

    def notes_and_stuck(start: str) -> tuple[list[str], list[str]]:
        eeprom = {"it": {"model": "24lc64"}}
        scene = scene_with(breaks_duties, ["I2C-A"], start=start, device=eeprom, budget=[STUCK])
        later = scene.start + scene.timebase.ticks(Fraction(3, 1000))
        scene.kernel.call_at(later, lambda: scene.devices["it"].log.take(Note("duty", "too soon", "the sheet")))
        scene.wires["SDA"].attach("hand").drive(0)
        result = scene.run(Fraction(30, 1000))
        return result.notes, result.stuck

    notes, stuck = notes_and_stuck("0 s")
    assert len(notes) == 4 and all("at " in note for note in notes) and len(stuck) == 1
    assert notes_and_stuck("7 ms") == (notes, stuck)


def receives_on_gpio36(dsp: Dsp) -> None:
    sci_fifo_receiver(dsp, 40, 12)
    gpio = dsp.module("GPIO")
    dsp.eallow()
    gpio.GPAMUX2.GPIO28 = 0
    gpio.GPBMUX1.GPIO36 = 1  # SCIRXDA
    dsp.compute(10)


def test_an_input_on_another_pin_than_the_wire_is_noted_with_the_key_to_add():
    result = scene_with(receives_on_gpio36, ["SCI-A", "GPIO"], host={}).run()
    notes = [note for note in result.notes if "has no wire" in note]
    assert notes == [
        "dsp: SCI-A has RX on GPIO36, where the case has no wire; add pins = { RX = 36 } to the unit",
    ]


@pytest.mark.parametrize(("wire", "key"), [("my-line_2", "my-line_2"), ("my line", '"my line"'), ("ü", '"ü"')])
def test_the_key_to_add_is_in_quotes_where_toml_needs_them(wire: str, key: str):
    (note, _) = scene_with(receives_on_gpio36, ["SCI-A", "GPIO"], {"pins": {wire: 28}}).run().notes
    assert note.endswith(f"add pins = {{ {key} = 36 }} to the unit")


def test_a_module_without_pins_is_not_noted():
    result = scene_with(lambda dsp: dsp.compute(10), ["SCI-A", "GPIO"], host={}).run()
    assert [note for note in result.notes if "has no wire" in note] == []


JUDGED = "budget=[{name='stretch', measure='stretch', max='1 ms'}, {name='missed', measure='missed rounds', max=99}]"


@pytest.mark.parametrize(("period", "missed"), [("5 ms", 0), ("1 ms", 12)])
def test_missed_rounds_that_no_budget_judges_are_noted(period: str, missed: int):
    changes = [f"controller.period='{period}'", "budget=[{name='stretch', measure='stretch', max='1 ms'}]"]
    result = Scene(load(TIMING / "responder.toml", changes)).run(Fraction(25, 1000))
    assert result.verdict == "pass" and result.counts["missed"] == missed
    assert result.notes == [
        "controller: 12 rounds that were due every 1000.000 us did not begin, because the one before was still "
        "running; a budget on 'missed rounds' judges that"
    ] * bool(missed)


def test_missed_rounds_that_a_budget_judges_are_not_noted():
    result = Scene(load(TIMING / "responder.toml", ["controller.period='1 ms'", JUDGED])).run(Fraction(25, 1000))
    assert result.counts["missed"] == 12 and result.notes == []


def test_a_note_on_lost_words_has_the_statement_and_the_number() -> None:
    def main(dsp: Dsp) -> None:
        sci = start_sci(dsp, "SCI-A")
        for value in range(20):
            sci.SCITXBUF.all = value  # no word has moved from the FIFO to the shift register yet

    notes = scene({"dsp": main}, unit={"dsp": unit("SCI-A")}, duration="1 ms").run().notes
    [note] = [note for note in notes if "is lost" in note]
    line = main.__code__.co_firstlineno + 3
    assert note.startswith("dsp SCI-A, first at ") and note.endswith("] (4 times)"), note
    assert f", line {line} of test_result.py: SCITXBUF was written while TXFFST = 16" in note


@pytest.mark.parametrize(("first", "shown"), [("100 ms", "100.000 ms"), ("1 s", "1000.000 ms"), ("99 ms", "")])
def test_a_controller_that_begins_after_the_case_ends_is_noted(first: str, shown: str):
    result = Scene(load(TIMING / "responder.toml", [f"controller.first='{first}'"])).run(Fraction(2, 1000))
    note = f"controller: its first round, at {shown}, is after the end of the case, 100.000 ms"
    assert result.notes == [note] * bool(shown)


def test_a_host_that_begins_after_the_case_ends_is_noted():
    result = Scene(load(TIMING / "uart_logger.toml", ["host.first='4 s'"])).run(Fraction(2, 1000))
    assert "host: its first frame, at 4000.000 ms, is after the end of the case, 200.000 ms" in result.notes


@pytest.mark.parametrize(
    ("inputs", "shown"),
    [
        ("rounds=['1 ms', '300 ms']", ""),
        ("rounds=['300 ms']", "controller: its first round, at 300.000 ms, is after the end of the case, 200.000 ms"),
        ("rounds=[]", ""),
        ("frames=['1 ms']", "controller: its first round, at 1000.000 ms, is after the end of the case, 200.000 ms"),
    ],
)
def test_the_first_round_is_that_of_the_inputs_if_they_list_rounds(inputs: str, shown: str):
    changes = ["duration='200 ms'", "controller.first='1 s'", f"inputs={{{inputs}}}"]
    notes = Scene(load(TIMING / "imu_hil_published.toml", changes)).run(Fraction(2, 1000)).notes
    assert [note for note in notes if "is after the end" in note] == [shown] * bool(shown)


TWO_MASTERS = """
name = "two_masters"
duration = "3 ms"

[unit.dsp]
firmware = "captured_master"
modules = ["I2C-A"]

[unit.dsp.settings]
script = ["50 W 00 3c"]
pauses = ["{pause}"]

[device.memory]
model = "24c02"

[controller]
first = "1 ms"
period = "100 ms"

[[controller.request]]
address = 0x51
count = 1

[[budget]]
name = "starts"
measure = "count of bus START"
max = {limit}

[[budget]]
name = "writes"
measure = "count of access W dsp:I2C-A.I2CMDR"
min = 1
"""


@pytest.mark.parametrize(
    ("pause", "limit", "verdict"),
    [("1 ms", 1, "not judged"), ("1 ms", 0, "fail"), ("1 s", 1, "pass")],
)
def test_bus_events_of_the_controller_alone_do_not_pass_beside_another_master(
    pause: str, limit: int, verdict: str, tmp_path: Path
):
    """controller  S 51 P        one START in the records
    dsp                  S 50 00 3c P
    """
    path = tmp_path / "two.toml"
    path.write_text(TWO_MASTERS.format(pause=pause, limit=limit), encoding="utf-8")
    starts, writes = Scene(load(path)).run().budgets
    assert starts.verdict == verdict
    why = "dsp.I2C-A sent as a master, but the events are those of [controller] only"
    assert (starts.found == why) is (pause == "1 ms")
    assert writes.verdict == "pass"


def test_a_unit_whose_name_contains_that_of_a_module_is_not_taken_for_a_master(tmp_path: Path):
    text = TWO_MASTERS.format(pause="1 s", limit=1).replace('["I2C-A"]', '["I2C-A", "SCI-A"]').replace("dsp:", "")
    path = tmp_path / "two.toml"
    path.write_text(text.replace("unit.dsp", 'unit."a.I2Cb"'), encoding="utf-8")
    assert [budget.verdict for budget in Scene(load(path)).run().budgets] == ["pass", "pass"]
