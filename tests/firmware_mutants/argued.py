"""Mutants without effect on this chip, argued: a mutant goes in; the reason comes out, or nothing.

An entry names the function, the kind of change, a part of the statement before and after, and why nothing can tell.
"""

from __future__ import annotations

from typing import NamedTuple

from .changes import Mutant


class Argument(NamedTuple):
    """kind: its begin. before, after: a part of the statement. Empty: any."""

    function: str
    kind: str
    before: str
    why: str
    after: str = ""


EARLY = "the start-up is over more than 4 ms before the first request, and nothing that it starts runs by time"
SETTING = "the setting is off in every case, so the statement does nothing"
SLAVE_COUNT = "a slave does not count bytes (I2C option cnt_in_slave_tx); lint: write without effect"
SLAVE_TRX = "TRX is a don't-care of a slave (SPRUG03B Table 7); lint: write without effect"
NO_CLOCK = "a slave makes no SCL: the divisors of the master's clock are never used"
IN_RESET = "the registers are independent, and the module is in reset until the last of them is written"
RESET_VALUE = "the register has this value after reset"
NO_GPIO = "there is a GPIO module in every case"

ARGUMENTS = (
    *(
        Argument(name, kind, "", EARLY)
        for name in ("start_pin", "start_i2c", "start_pie")
        for kind in ("20 c", "300 c")
    ),
    *(Argument("sci_fifo_receiver", kind, "", EARLY) for kind in ("20 c", "300 c")),
    *(Argument("run", kind, "start_", EARLY) for kind in ("20 c", "300 c")),
    *(Argument("run", kind, "sci_fifo_receiver", EARLY) for kind in ("20 c", "300 c")),
    Argument("sci_received", "", "self.dsp.compute(self.settings.frame_cost", SETTING),
    Argument("sci_received", "deleted", "if self.settings.frame_cost", SETTING),
    Argument("sci_received", "moved past", "if self.settings.frame_cost", SETTING),
    Argument("sci_received", "moved past if self.settings.frame_cost", "", SETTING),
    Argument("sci_received", "", "self.frame_waits = True", "only models that run frame by frame ask for it"),
    Argument("sci_received", "moved past", "sci.SCIFFRX.RXFFOVRCLR", "the two flags are independent"),
    Argument("sci_received", "exchanged", "sci.SCIFFRX.RXFFOVRCLR", "nothing overflows in a case of this firmware"),
    Argument("sci_received", "moved past pie.PIEACK", "", "no character comes within the cycle between them"),
    Argument("batch_read", "", "if self.settings.mask_during_i2c", SETTING),
    Argument("batch_read", "moved past if self.settings.mask_during_i2c", "", SETTING),
    Argument("batch_read", "", "dsp.dint()", SETTING),
    Argument("batch_read", "", "dsp.eint()", SETTING),
    Argument("batch_read", "", "i2c.I2CCNT.all", SLAVE_COUNT),
    Argument("batch_read", "", "i2c.I2CMDR.TRX", SLAVE_TRX),
    Argument("batch_read", "exchanged", "i2c.I2CMDR.IRS = 1", "IRS is 1 there, and the next own address sets it anew"),
    Argument("batch_read", "deleted", "i2c.I2CMDR.IRS = 1", "IRS is 1 there, and the next own address sets it anew"),
    Argument("batch_read", "", "return i2c.I2CSTR.NACK", "nobody uses what it returns"),
    Argument("batch_read", "moved past buffer", "if self.settings.sdir_wait", "making the iterator takes no time"),
    Argument("batch_read", "20 c", "i2c.I2CSTR.SCD", "the wait for SDIR goes on for 80 us"),
    Argument("batch_read", "300 c", "i2c.I2CSTR.SCD", "the wait for SDIR goes on for 80 us"),
    Argument("slave_config", "", "i2c.I2CMDR.MST = 0", "MST is never set, and STT never makes a START"),
    Argument("start_pin", "", "return", NO_GPIO),
    Argument("start_pin", "deleted", "if not dsp.has('GPIO')", NO_GPIO),
    Argument("start_pin", "moved past", "", "the pin's level and its port's name do not depend on each other"),
    Argument("start_i2c", "", "i2c.I2CCLK", NO_CLOCK),
    Argument("start_i2c", "moved past", "", IN_RESET),
    Argument("start_i2c", "deleted", "i2c.I2CMDR.all = 0", RESET_VALUE),
    Argument("start_i2c", "", "i2c.I2COAR.all", "the own address is set again before the first request"),
    Argument("start_i2c", "deleted", "dsp.edis()", "protection that stays off stops nothing that is right"),
    Argument("start_i2c", "", "gpio.GPBQSEL1", "a qualified pin is two cycles late, far less than a bit"),
    Argument("sci_fifo_receiver", "moved past", "", IN_RESET),
    Argument("sci_fifo_receiver", "", "sci.SCICTL2.all", RESET_VALUE),
    Argument("sci_fifo_receiver", "", "gpio.GPAMUX2.GPIO29", "nothing is sent on TX"),
    Argument("sci_fifo_receiver", "", "gpio.GPAQSEL2", "a qualified pin is two cycles late, far less than a bit"),
    Argument("sci_fifo_receiver", "", "sci.SCIHBAUD.all", RESET_VALUE),
    Argument("sci_fifo_receiver", "", "sci.SCIFFRX.all = 0", "the next write sets all of it"),
    Argument("sci_fifo_receiver", "deleted", "dsp.edis()", "protection that stays off stops nothing that is right"),
    Argument("start_pie", "", "pie.PIEACK.all", "PIEACK resets to 0 (system option pieack_reset)"),
    Argument("start_pie", "moved past", "", "nothing asks for an interrupt before INTM is cleared"),
)


def why_without_effect(mutant: Mutant) -> str:
    """The reason; empty for a mutant that some budget should catch."""
    for one in ARGUMENTS:
        fits = one.function in ("", mutant.function) and mutant.kind.startswith(one.kind)
        if fits and one.before in mutant.before and one.after in mutant.after:
            return one.why
    return ""
