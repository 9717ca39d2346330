"""Co-simulation: a case runs inside a Verilog or VHDL simulator, connected by cocotb.

dut.scl, dut.sda, dut.rx --> F28335 --> dut.dsp_scl, dut.dsp_sda, dut.tx
simulate(sources, ...)   --> a run of the simulator, called from a test of pytest

A step is the simulator's smallest unit of time, and a tick is the smallest unit of time of the case. A line is a wire
that the case and the HDL design share. Our pins are the signals that the case drives. `dut` is the top level of the
design, as in cocotb. A session (`outside.session.Session`) runs a case in parts: each part ends at a given tick, and
lines can change between two parts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..outside.errors import OutsideError
from .simulate import simulate

if TYPE_CHECKING:
    from .f28335 import F28335

__all__ = ["F28335", "OutsideError", "simulate"]


def __getattr__(name: str) -> Any:
    """Import `F28335` on first use. It can be imported only inside a simulator; `simulate` is called outside of one."""
    if name != "F28335":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        from .f28335 import F28335
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != "cocotb":
            raise
        raise OutsideError("F28335 needs cocotb 2; pip install 'periph-sim[cosim]'") from None
    return F28335
