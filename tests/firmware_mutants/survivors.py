"""Mutants that are known to survive, though this chip or another scene could tell: text of each -> what would.

They are no arguments: they count as survivors. One that survives and does not stand here fails the run.
"""

from __future__ import annotations

KNOWN = {
    "slave_config: exchanged: i2c.I2CMDR.MST = 0 --> i2c.I2CMDR.MST = 1": (
        "a write of STT, which no firmware here makes: without it a module with MST = 1 answers its address as before"
    ),
    "wait_for_round: moved past self.look_at_round(): self.look_at_line()": (
        "a timer that runs out, or a frame that ends, within the few cycles by which the timer is looked at sooner"
    ),
    "run: moved past self.start_timer(self.round_timer, settings.period - settings.guard): "
    "start_pie(dsp, {'SCIRXINTA': self.sci_received})": (
        "a frame that ends within the few cycles by which the round's timer starts sooner, 19.5 ms later"
    ),
    "run: moved past self.start_timer(self.wait_timer, settings.patience): "
    "self.start_timer(self.round_timer, settings.period - settings.guard)": (
        "a frame that ends within the few cycles by which the round's timer starts later, 19.5 ms later"
    ),
}
