"""timing/imu_hil.toml and its fault cases give the results they describe: both firmwares, dead hosts, late writes."""

from __future__ import annotations

from fractions import Fraction
from itertools import count
from typing import NamedTuple

import pytest

from periph_sim import Scene, load
from periph_sim.scene.firmware_loader import load_firmware
from tests.profiles import explores
from tests.scene.late_code import WRITE, broken, cycle, kept, late
from tests.scene.runs import TIMING, run_file

PUBLISHED, ROBUST = "unit.dsp.firmware=imu_hil", "unit.dsp.firmware=imu_hil_robust"
FAULTS = {  # budgets that fail with the published firmware
    "imu_hil_lost_byte": {"wrong bytes", "data age"},
    "imu_hil_broken_line": {"wrong bytes", "data age", "SCI FIFO high-water", "SCI overruns"},
    "imu_hil_silent_host": {"fresh again"},
    "imu_hil_doubled_frame": {"data age"},
    "imu_hil_spikes": {"data age"},
    "imu_hil_stuck_sda": {"data age"},
    "imu_hil_reset": {"wrong bytes", "data age"},
    "imu_hil_module_reset": {"missed rounds", "nacked rounds", "bus stuck", "data age"},
}


@pytest.mark.parametrize("name", ["imu_hil", "imu_hil_400k"])
@pytest.mark.parametrize("firmware", [PUBLISHED, ROBUST])
def test_both_firmwares_keep_every_budget_of_the_bench(name: str, firmware: str):
    assert run_file(name, "0.6", firmware).result.verdict == "pass"


def test_the_hosts_frames_drift_through_all_phases_of_the_rounds():
    """488 frames in 10 s end in each millisecond of a period, and in each tenth of the 2.62 ms that a round takes."""
    case = load(TIMING / "imu_hil.toml", [])
    scene = Scene(case.model_copy(update={"unit": {}, "controller": None, "budget": ()}))
    ends: list[Fraction] = []
    scene.host.sent.append(lambda number, values, tick: ends.append(scene.timebase.seconds(tick)))
    scene.run()
    phases = [(end * 1000 / (1 + Fraction(30, 10**6)) - 5) % 20 for end in ends]
    assert len(ends) == 488
    assert {int(phase) for phase in phases} == set(range(20))
    assert {int(phase / Fraction(262, 1000)) for phase in phases} >= set(range(10))


@pytest.mark.parametrize("frames", [0, 1, 2, 3, 4, 7, 20, 50] if explores() else [0, 1, 3, 20])
@pytest.mark.parametrize("firmware", [PUBLISHED, ROBUST])
def test_a_host_that_dies_at_any_frame_fails(frames: int, firmware: str):
    ran = run_file("imu_hil", f"{0.2 + frames * 0.021:.1f}", firmware, f"host.frames={frames}")
    assert ran.result.verdict != "pass"
    (age,) = (verdict for verdict in ran.result.budgets if verdict.name == "data age")
    assert not age.passed


@pytest.mark.parametrize("name", FAULTS)
def test_only_the_robust_firmware_keeps_the_budgets_of_a_fault_case(name: str):
    robust, published = (run_file(name, "1.2", firmware) for firmware in (ROBUST, PUBLISHED))
    assert robust.broken() == []
    assert FAULTS[name] >= set(published.broken()) != set()


def test_glitches_hang_the_published_firmware_only():
    robust, published = (run_file("imu_hil_glitches", "3", firmware) for firmware in (ROBUST, PUBLISHED))
    assert robust.result.verdict == "pass"
    assert {"missed rounds", "bus stuck"} <= set(published.broken())


@pytest.mark.parametrize(
    "code",
    [
        {"between_accesses": 1, "poll_pass": 7, "isr_prologue": 6, "isr_epilogue": 3},
        {"between_accesses": 15, "poll_pass": 21, "isr_prologue": 22, "isr_epilogue": 18},
    ],
    ids=["short code", "long code"],
)
@pytest.mark.parametrize("firmware", [PUBLISHED, ROBUST])
def test_every_budget_holds_at_both_ends_of_the_cost_of_compiled_code(code: dict[str, int], firmware: str):
    changes = [f"unit.dsp.code.{key}={value}" for key, value in code.items()]
    assert run_file("imu_hil", "0.6", firmware, *changes).broken() == []


def test_three_hundred_cycles_before_each_write_break_the_reaction_and_nothing_else():
    result, _ = late(WRITE, 300)
    assert {verdict.name for verdict in result.budgets if verdict.broken} == {"reaction"}


def test_the_robust_firmware_refuses_a_guard_that_is_shorter_than_its_models():
    with pytest.raises(ValueError, match="guard must be longer than the model run"):
        load_firmware("imu_hil_robust").settings(guard=Fraction(1, 10_000))  # type: ignore[operator]


# One line breaks each budget: the table of docs/flagship.md ------------------------------


class Break(NamedTuple):
    """A change of imu_hil.py or of a setting. old, new: texts in the source. text: the change as the page shows it."""

    text: str
    old: str = ""
    new: str = ""
    settings: tuple[str, ...] = ()


def before(statement: str, inserted: str) -> Break:
    return Break(f"`{inserted}` before `{statement}`", statement, f"{inserted}; {statement}")


def setting(change: str) -> Break:
    return Break(f"`--set {change}`", settings=(change.replace("'", ""),))


def without(statement: str) -> Break:
    return Break(f"without `{statement}`", statement, "pass")


SHORT = "duration=300 ms"
PAGE = (TIMING.parent / "docs" / "flagship.md").read_text(encoding="utf-8")
BREAKS = {
    "reaction": before(WRITE, "dsp.compute(300)"),
    "reaction at the latest": before(WRITE, "dsp.compute(600)"),
    "I2CDXR margin": before(WRITE, "dsp.compute(2000)"),
    "stretch": before(WRITE, "dsp.compute(2300)"),
    "service routine": before("self.frame_waits = True", "self.dsp.compute(400)"),
    "service latency": setting("unit.dsp.settings.mask_during_i2c=true"),
    "own address": before("i2c.I2CMDR.IRS = 0", "self.dsp.compute(9000)"),
    "latest own address": setting("unit.dsp.settings.beyond_estimate='420 us'"),
    "module off": before("i2c.I2COAR.all = address", "self.dsp.compute(300)"),
    "CPU load": before("dsp.clear_pin(settings.pin)", "dsp.compute(60000)"),
    "lost flags": before("i2c.I2CSTR.SCD = 1", "dsp.compute(16000)"),
    "wrong bytes": Break("`0x7F` instead of `0xFF` in `sci_received`", "SCIRXBUF.all & 0xFF", "SCIRXBUF.all & 0x7F"),
    "overflows": setting("host.motion.angles.2.frequency='7 Hz'"),
    "data age": setting("host.frames=4"),
    "missed rounds": before(WRITE, "dsp.compute(600000)"),
    "nacked rounds": without("i2c.I2COAR.all = address"),
    "SCI FIFO high-water": without("sci.SCIFFRX.RXFFINTCLR = 1"),
    "SCI overruns": without("sci.SCIFFRX.RXFFINTCLR = 1"),
}


@pytest.mark.parametrize("budget", BREAKS)
def test_one_line_breaks_each_budget_as_the_page_shows(budget: str):
    change = BREAKS[budget]
    (row,) = (line for line in PAGE.splitlines() if line.startswith(f"| {budget} |"))
    assert row.endswith(f"| {change.text} |")
    found = broken("imu_hil", change.old, change.new, *change.settings, SHORT)
    assert found[budget] == ("not judged" if budget == "own address" else "fail")


NOT_RAN = "            if not ran:\n                self.model()\n"
SOONER = "budget.runs of the models.exactly=17"  # the start, 15 frames in 0.3 s, and the first round
BY_FRAME_BREAKS = {
    "reaction": BREAKS["reaction"],
    "service routine": BREAKS["service routine"],
    "module off": BREAKS["module off"],
    "service latency": setting("host.first='5 ms'"),
    "data age": setting("host.frames=4"),
    "latest own address": Break("", "                ran = True", "                ran = False"),
    "frame to models": before("self.frame_waits = True", "self.dsp.compute(300)"),
    "runs of the models": Break("", NOT_RAN, ""),
}


@pytest.mark.parametrize("budget", ["", *BY_FRAME_BREAKS])
def test_one_line_breaks_each_budget_of_the_models_by_frame(budget: str):
    change = BY_FRAME_BREAKS.get(budget, Break(""))
    found = broken("imu_hil_by_frame", change.old, change.new, *change.settings, SHORT, SOONER)
    assert budget in found if budget else not found


def test_every_budget_of_the_bench_but_the_inputs_has_such_a_line():
    inputs = {"model execution", "response", "round complete", "schedule slack"}
    assert {budget.name for budget in load(TIMING / "imu_hil.toml", []).budget} == BREAKS.keys() | inputs


SDIR_PASS, PASS = 10, 17  # cycles of a pass of the waits: SDIR is one read, XRDY and SCD are two
BYTES, WRITES = 6, 7  # of a reply: XRDY requests one byte more than the head reads
ROUND = "0.008"  # s: the first round and no more


def margin_steps(cycles: int, number: int | None = None) -> list[int]:
    """Return the changes of the margins of a round's bytes with extra cycles before each write, or before one write."""
    writes = count()
    _, plain = late(WRITE, 0, seconds=ROUND)
    _, later = late(WRITE, cycles, seconds=ROUND, when=lambda: number in (None, next(writes)))
    length = cycle(plain)
    steps = [(b - a) / length for a, b in zip(kept(plain, MARGIN), kept(later, MARGIN), strict=True)]
    assert len(steps) == 3 * BYTES
    assert all(abs(step - round(step)) * length <= 1 for step in steps)  # whole cycles, to the tick
    return [round(step) for step in steps]


MARGIN = "I2CDXR margin"


@pytest.mark.parametrize("byte", range(BYTES))
@pytest.mark.parametrize("reply", range(3))
def test_twenty_cycles_before_one_write_reduce_its_margin_by_exactly_twenty(reply: int, byte: int):
    steps = margin_steps(20, reply * WRITES + byte)
    place = reply * BYTES + byte
    assert steps[: place + 1] == [0] * place + [-20]
    assert all(abs(step) < PASS for step in steps[place + 1 :])  # polls of later waits begin at another phase


def test_twenty_cycles_before_each_write_reduce_each_margin_by_twenty_and_the_change_of_the_poll_delay():
    """A poll finds its flag 0 to PASS - 1 cycles late, with and without the delay, so the two may differ by that."""
    steps = margin_steps(20)
    assert steps[0] == -20
    for place, step in enumerate(steps):
        found = -step - 20
        assert abs(found) < (PASS if place % BYTES else SDIR_PASS)


def test_the_change_of_a_poll_delay_follows_from_the_previous_write():
    """Polls keep their distance to the previous write, so their change differs from its change by whole passes."""
    steps = margin_steps(20)
    for reply in range(3):
        first, *others = steps[reply * BYTES : (reply + 1) * BYTES]
        for before, step in zip([first, *others], others, strict=False):
            assert (step + 20 - before) % PASS == 0


@pytest.mark.parametrize("passes", [1, 20])
def test_whole_passes_before_each_write_reduce_each_margin_by_exactly_their_cycles(passes: int):
    assert margin_steps(passes * PASS) == [-passes * PASS] * 3 * BYTES
