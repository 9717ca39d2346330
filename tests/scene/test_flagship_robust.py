"""timing/imu_hil_robust.toml: its budgets hold at both ends of its phases, and one line breaks each of them."""

from __future__ import annotations

import pytest

from periph_sim import load
from tests.scene.late_code import broken
from tests.scene.runs import TIMING

CASE = "imu_hil_robust"
SEND, OWN = "self.i2c.I2CDXR.all = byte", "i2c.I2COAR.all = address"
MODEL_AT_START = "self.model()\n        while True:"
# With such a patience only the interrupt empties the FIFO before the next frame.
NO_ACKNOWLEDGE = ("self.pie.PIEACK.all = GROUP_9", "pass", "unit.dsp.settings.patience=30 ms")
BREAKS = {  # budget -> an old text of the source, a new one, changes of the case
    "reaction": (SEND, f"self.dsp.compute(300); {SEND}"),
    "stretch": (SEND, f"self.dsp.compute(2300); {SEND}"),
    "missed rounds": (SEND, f"self.dsp.compute(600000); {SEND}"),
    "service routine": ("self.frame_waits = True", "self.frame_waits = True; self.dsp.compute(300)"),
    "service latency": ("timer.TCR.all = RELOAD\n        self.dsp.spin", "self.dsp.dint(); self.dsp.spin"),
    "frame to models": ("dsp.set_pin(self.settings.pin)", "dsp.compute(300); dsp.set_pin(self.settings.pin)"),
    "runs of the models": ("        if not ran:\n            self.model()\n", ""),
    "own address": ("i2c.I2CMDR.all = 0", "self.dsp.compute(9000); i2c.I2CMDR.all = 0"),
    "module off": (OWN, f"{OWN}; self.dsp.compute(300)"),
    "nacked rounds": (OWN, "pass"),
    "wrong bytes": ("word & 0xFF", "word & 0x7F"),
    "overflows": ("", "", "host.motion.angles.2.frequency=7 Hz"),
    "data age": ("        self.left = left\n", ""),
    "fresh data": ("", "", "host.frames=4"),
    "SCI FIFO high-water": NO_ACKNOWLEDGE,
    "SCI overruns": NO_ACKNOWLEDGE,
}
MISTAKES = {  # mistakes that the cases of faults do not detect
    "models without a frame at the start": (MODEL_AT_START, "while True:", "runs of the models"),
    "frames wait for a round that is overdue": ("self.look_at_round()\n", "pass\n", "frame to models"),
    "RX keeps its error flag after an empty FIFO": ("sci.SCIRXST.RXERROR", "sci.SCIRXST.RXRDY", "data age"),
}


@pytest.mark.parametrize("first", ["72.7 ms", "81.1 ms", "88.8 ms"])
def test_every_budget_holds_wherever_frames_end_between_two_rounds(first: str):
    assert broken(CASE, "", "", f"controller.first={first}") == {}


@pytest.mark.parametrize("budget", BREAKS)
def test_one_line_breaks_each_budget_of_the_robust_firmware(budget: str):
    assert budget in broken(CASE, *BREAKS[budget])


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistakes_that_other_cases_let_pass_break_a_budget(mistake: str):
    old, new, budget = MISTAKES[mistake]
    assert budget in broken(CASE, old, new)


def test_every_budget_has_such_a_line_and_a_reason():
    budgets = load(TIMING / f"{CASE}.toml", []).budget
    assert {budget.name for budget in budgets} == BREAKS.keys()
    assert all(budget.why for budget in budgets)
