"""Table of the CPU timer registers. Source: SPRUFB0D section 5.5, Tables 31 to 38. None is EALLOW-protected.

C2000Ware's DSP2833x_CpuTimers.h has TIMH:TIM and PRDH:PRD each as one 32-bit field `all`.
"""

from __future__ import annotations

from ...core.registers import Register, RegisterMap, Yields, field

BASES = (0x0C00, 0x0C08, 0x0C10)  # base addresses of timers 0, 1, 2

TIM = Register(
    "TIM",
    0x0,
    "SPRUFB0D Table 32",
    (field("TIM", "15:0", doc="low half of the count"),),
    yields=Yields.TIME,
    upper="TIMH",
)
TIMH = Register(
    "TIMH", 0x1, "SPRUFB0D Table 33", (field("TIMH", "15:0", doc="high half of the count"),), yields=Yields.TIME
)
PRD = Register(
    "PRD",
    0x2,
    "SPRUFB0D Table 34",
    (field("PRD", "15:0", "R/W", 0xFFFF, doc="low half of the period"),),
    upper="PRDH",
)
PRDH = Register("PRDH", 0x3, "SPRUFB0D Table 35", (field("PRDH", "15:0", doc="high half of the period"),))
TCR = Register(
    "TCR",
    0x4,
    "SPRUFB0D Table 36",
    (
        field("TIF", "15", "R/W1C", doc="1: the count has reached zero"),
        field("TIE", "14", doc="1: reaching zero requests an interrupt"),
        field("FREE", "11", doc="1: continues at a breakpoint"),
        field("SOFT", "10", doc="with FREE = 0: 1 stops at zero, 0 at the next step, after a breakpoint"),
        field("TRB", "5", "W1", doc="1: reload count and prescaler"),
        field("TSS", "4", doc="1: stopped"),
    ),
)
TPR = Register(
    "TPR",
    0x6,
    "SPRUFB0D Table 37",
    (
        field("PSC", "15:8", "R", doc="low half of the prescale count"),
        field("TDDR", "7:0", doc="low half of the prescale divider, less one"),
    ),
    yields=Yields.TIME,
)
TPRH = Register(
    "TPRH",
    0x7,
    "SPRUFB0D Table 38",
    (
        field("PSCH", "15:8", "R", doc="high half of the prescale count"),
        field("TDDRH", "7:0", doc="high half of the prescale divider, less one"),
    ),
    yields=Yields.TIME,
)

MAP = RegisterMap("CPU timer", "SPRUFB0D section 5.5", (TIM, TIMH, PRD, PRDH, TCR, TPR, TPRH))
