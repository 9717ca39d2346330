"""Scenes whose records depend on options of the system: Python firmware, or an image if instructions matter."""

from __future__ import annotations

from periph_sim.core.options import Value
from tests.options.unit import Scene
from tests.processor.image.rig import ENPIE, HEAD, VECTOR, timer

TIMER0 = "TCR=10 PRDH=0 PRD=63 TCR=4020 "  # every 100 cycles, TIE, started
SCI = "PCLKCR0=400 +10 SCICCR=7 SCICTL1=3 SCIHBAUD=0 SCILBAUD=18 SCICTL1=23 "
PADS = "PCLKCR3=2000 +10 GPADIR=20000000 GPASET=20000000 GPACLEAR=20000000 "  # GPIO29 is the wire SCITXDA


def image(code: str, *modules: str, after_end: str = "") -> Scene:
    """Return a scene of a program that reads a register at its end, so that the time of the end is recorded.

    code: lines separated by ";". after_end: code after the end.
    """
    lines = "".join(f"{line if line.rstrip().endswith(':') else f' {line.strip()}'}\n" for line in code.split(";"))
    end = f" MOVW DP,#WDCR >> 6\n MOV AL,@WDCR\n ESTOP0\n{after_end}"
    return Scene(source=f"{HEAD}{lines}{end}", modules=modules)


ROUTINE = " .global _routine\n_routine: IRET\n"
INTR = ENPIE + VECTOR.replace("0x0D4C", "0x0D40") + " OR IFR,#1 ; INTR INT1"

SCENES = {
    # CPU interrupts
    "asleep": image(f"{timer(200)} CLRC INTM ; IDLE", "TIMER0", after_end=ROUTINE),
    "two interrupts": Scene(TIMER0 + "+400 TCR", ("TIMER0",), service={"TINT0": "TCR=c000 +150 PIEACK=1"}, cycles=2000),
    "INTR with its flag": image(f"{INTR} ; MOVW DP,#0x0C00 >> 6 ; PUSH IFR ; POP @0x0C02", "TIMER0", after_end=ROUTINE),
    # PIE
    "PIEACK read": Scene("PIEACK"),
    "a line held": Scene(
        "PCLKCR0=10 +10 I2CPSC=e I2CIER=10 I2CMDR=20 +1000",
        ("I2C-A",),
        service={"I2CINT1A": "PIEIFR8 PIEACK=80 PIEIFR8 I2CISRC"},
        answers={"i2c": {"int_line": "level"}},
    ),
    # bus
    "frame 2 read": Scene("WDCR"),
    "frame 0 polled": Scene(TIMER0 + "~TIF", ("TIMER0",)),
    "frame 2 written": Scene("WDCR=68 PIECTRL"),
    "frame 1 written twice": Scene("GPACLEAR=1 GPACLEAR=2 PIECTRL", ("GPIO",)),
    "written and read": Scene("WDCR=68 WDCR"),
    # instructions of an image
    "waits for a register": image("MOVW DP,#COUNT >> 6 ; MOVL XAR4,@COUNT ; MOV AL,*XAR4"),
    "waits for a word": image("MOVW DP,#COUNT >> 6 ; MOV @COUNT,#1 ; MOV AL,@COUNT"),
    "code and data in one block": image("MOVW DP,#COUNT >> 6 ; MOV @COUNT,#1"),
    "branch": image("B next,UNC ; next:"),
    "push": image("MOVL *SP++,ACC"),
    "jump to an odd address": image(".align 2 ; LB #there ; .space 1 ; there: MOVL XAR6,#0x12345"),
    "delay slot of the FPU": image(
        "MOVIZ R0H,#0x4000 ; MPYF32 R2H,R0H,R0H ; MOV32 R3H,R2H ; NOP ; NOP ; MOVW DP,#0x0C00 >> 6 ; MOV32 @0x0C02,R3H",
        "TIMER0",
    ),
    "code in flash": image(
        "EALLOW ; MOVW DP,#0x0A80 >> 6 ; MOV @0x0A86,#0x505 ; MOV @0x0A80,#1 ; EDIS ; MOVL XAR4,#0x300800 ; LB #there ;"
        ' .sect "constant", 0x300800 ; .word 7 ; .sect "code", 0x300000 ; there: NOP ; NOP ; NOP ; MOV AL,*XAR4 ; NOP'
        " ; NOP ; NOP ; NOP ; NOP",
        after_end=" .space 8\n",
    ),
    "RPT of a location": image("MOVW DP,#COUNT >> 6 ; MOV @COUNT,#0x102 ; RPT @COUNT || NOP"),
    # GPIO
    "pin set": Scene(PADS, ("GPIO",)),
    "peripheral on a pin": Scene(SCI + "GPAMUX2=4000000 SCITXBUF=55", ("GPIO", "SCI-A")),
    # timers and clocks
    "timer": Scene("TPR=9 PRDH=0 PRD=9 TCR=4020 +200", ("TIMER0",), service={"TINT0": "TCR=8000"}),
    "TIE late": Scene("TCR=10 PRDH=0 PRD=63 TCR=20 +150 TCR=4010 +10 PIEIFR1", ("TIMER0",)),
    "PLL": Scene("PLLSTS=40 PLLCR=5 +100 WDCR"),
    "LSPCLK": Scene("LOSPCP=7 " + SCI + "+13 LOSPCP=7 SCITXBUF=55", ("SCI-A",)),
    "watchdog": Scene("WDCR=28 +4000 WDKEY=55 WDKEY=aa " + "+600 WDCNTR " * 5),
    "wrong key": Scene("WDCR=28 WDKEY=12 +100 WDCR"),
}

ROWS: list[tuple[str, str, Value]] = [  # option, scene, an answer that gives other records
    ("int_latency", "asleep", 16),
    ("vector_fetch_waits", "asleep", 2),
    ("idle_wake", "asleep", 7),
    ("irq_after_iret", "two interrupts", "after_one_instruction"),
    ("intr_clears_ifr", "INTR with its flag", False),
    ("pieack_reset", "PIEACK read", 0xFFF),
    ("pie_held_line", "a line held", "at_vector_fetch"),
    ("pf2_read_ws", "frame 2 read", 5),
    ("pf2_read_ws", "frame 0 polled", 0),
    ("pf2_write_ws", "frame 2 written", 5),
    ("pf1_back_to_back_write", "frame 1 written twice", 0),
    ("write_lands", "written and read", 4),
    ("stalls", "waits for a register", False),
    ("stalls", "waits for a word", False),
    ("b_unc_cycles", "branch", 4),
    ("push_acc_cycles", "push", 2),
    ("odd_32bit_target", "jump to an odd address", 0),
    ("saram_conflict", "code and data in one block", 1),
    ("fpu_delay_slot", "delay slot of the FPU", "old_value"),
    ("flash_model", "code in flash", "beside_reads"),
    ("rptc_width", "RPT of a location", 8),
    ("gpio_out_delay", "pin set", 0),
    ("gpio_out_delay", "peripheral on a pin", 0),
    ("timer_tif_point", "timer", "on_reload"),
    ("timer_late_tie", "TIE late", "waits_for_zero"),
    ("pll_lock_clock", "PLL", "osc_div_2"),
    ("lspclk_phase", "LSPCLK", "restart_on_write"),
    ("wd_divider", "watchdog", "free_running"),
    ("wd_bad_key", "wrong key", "reset"),
]
