"""What the result of a run says of all that happened in it."""

from __future__ import annotations

from fractions import Fraction

from periph_sim.core.chip import Note
from periph_sim.processor.dsp import Dsp
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene
from tests.scene.small import case

STUCK = {"name": "stuck", "measure": "stuck", "max": 5}


def test_ten_sentences_of_stuck_lines_are_shown_and_all_are_counted():
    scene = Scene(case(chip={"gyroscope": {"model": "itg3200", "values": {"fixed": [10, -20, 30]}}}))
    scene.stuck.sentences += [f"SDA is held low, {n}" for n in range(12)]
    result = scene.run(Fraction(0))
    assert result.stuck == scene.stuck.sentences[:10] and result.counts["stuck"] == 12


def result(counts: dict[str, int]) -> Result:
    return Result("x", "pass", 1.0, 1.0, 0, 0, 0, [], counts, [], [], [])


def test_what_is_not_said_of_a_run_is_nothing():
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


def test_times_of_notes_count_from_the_begin_of_the_run():
    """A duty of a module and of a device, an overflow, the end of main and a line that is held low."""

    def told(start: str) -> tuple[list[str], list[str]]:
        unit = {"dsp": {"firmware": "under test", "modules": ["I2C-A"]}}
        made = case(unit=unit, start=start, device={"it": {"model": "24lc64"}}, budget=[STUCK])
        program = Firmware("under test", lambda dsp, settings: breaks_duties(dsp), None)
        scene = Scene(made, programs={"dsp": program})
        later = scene.start + scene.timebase.ticks(Fraction(3, 1000))
        scene.kernel.call_at(later, lambda: scene.devices["it"].log.take(Note("duty", "too soon", "the sheet")))
        scene.wires["SDA"].attach("somebody").drive(0)
        result = scene.run(Fraction(30, 1000))
        return result.notes, result.stuck

    notes, stuck = told("0 s")
    assert len(notes) == 4 and all("at " in note for note in notes) and len(stuck) == 1
    assert told("7 ms") == (notes, stuck)
