"""Open questions about the CPU and the system around the peripherals: one field each, with the default answer first.

Clocks, PIE, timers, GPIO, the bus and the CPU share this class, so that a unit has one answer to each question.
"""

from __future__ import annotations

from ..core.options import Answers, BoolOption, IntOption, TextOption, choice, number


class SystemOptions(Answers):
    # CPU interrupts
    int_latency: IntOption = number(
        14,
        13,
        16,
        unit="cycles",
        question="From a peripheral's request to the first instruction of its service routine: 14 in the field, "
        "while the documents give delays that add up to 13 to 16. vector_fetch_waits adds to it.",
    )
    vector_fetch_waits: IntOption = choice(
        0,
        1,
        2,
        question="How many cycles do the wait states of the vector fetch from the PIE's memory add: none to the "
        "cycles of int_latency, TRAP and INTR, one for a fetch of 32 bits, or two for two of 16?",
    )
    idle_wake: IntOption = number(
        0,
        0,
        16,
        unit="cycles",
        question="From the IFR bit that ends IDLE to the interrupt's entry, or to the next instruction with INTM = 1: "
        "the page of IDLE (SPRU430F) does not say.",
    )
    irq_after_iret: TextOption = choice(
        "at_once",
        "after_one_instruction",
        question="Does an interrupt that waits at IRET come before the next instruction of the interrupted code?",
    )
    intr_clears_ifr: BoolOption = choice(
        True,
        False,
        question="Does INTR clear the IFR bit (CPU guide section 3.3.1) or not (system guide section 8.5.3 note 3)?",
        registers="IFR",
    )

    # PIE
    pieack_reset: IntOption = choice(
        0x000,
        0xFFF,
        question="Does PIEACK hold all groups after reset, as the register's drawing says, or none? TI's examples for "
        "I2C, timers and SCI never write PIEACK before their first interrupt, and run on silicon.",
        registers="PIEACK",
    )

    pie_held_line: TextOption = choice(
        "at_pieack",
        "at_vector_fetch",
        question="When does the PIE latch a request line again that is still held after its interrupt was served: when "
        "the group is acknowledged, or as soon as the vector fetch has cleared PIEIFR?",
    )

    # Bus
    pf2_read_ws: IntOption = number(
        2, 0, 15, unit="wait states", question="What does a read in peripheral frame 2 cost beyond its one cycle?"
    )
    pf2_write_ws: IntOption = number(
        0, 0, 15, unit="wait states", question="What does a write in peripheral frame 2 cost beyond its one cycle?"
    )
    pf1_back_to_back_write: IntOption = choice(
        1, 0, question="How many cycles does a write in peripheral frame 1 directly after another one cost in addition?"
    )
    write_lands: IntOption = choice(
        2,
        4,
        question="How many cycles after its own instruction could have read does a write reach the peripheral: 2, from "
        "pipeline stage R2 to W, or 4, which the three cycles of write-to-read protection imply?",
    )

    # Instructions of an image
    stalls: BoolOption = choice(
        True,
        False,
        question="Do instructions wait for registers and words that earlier ones have not written yet? The rules are "
        "printed (SPRU430F 4.4), but no cycle trace of compiled code is public.",
    )
    b_unc_cycles: IntOption = choice(
        7, 4, question="What does B with UNC take? Only the page of SB names an exception for it."
    )
    push_acc_cycles: IntOption = choice(
        1, 2, question="What does PUSH ACC take? Its page says 2, that of MOVL *SP++,ACC, the same code word, 1."
    )
    odd_32bit_target: IntOption = choice(
        1,
        0,
        question="How many cycles more does a jump to an instruction of 32 bits at an odd address take? It needs "
        "two fetches (SPRU430F 4.3.2).",
    )
    saram_conflict: IntOption = choice(
        0,
        1,
        question="How many additional cycles does a data access take in the block from which the program is fetched?",
    )
    fpu_delay_slot: TextOption = choice(
        "at_once",
        "old_value",
        question="What does an instruction read in the delay slot of an FPU operation of 2p cycles, which nothing "
        "protects: the result already, or what the register held before?",
    )
    flash_model: TextOption = choice(
        "shared_with_reads",
        "beside_reads",
        "two_words_ahead",
        question="With FOPT.ENPIPE = 1, does a read of data in flash wait for a fetch under way, and the next fetch "
        "for the read; or does the prefetch fill its two words of 64 bits and the CPU's queue whatever data are read; "
        "or are only two words fetched ahead? SPRUFB0D section 2.2 says that data reads from flash bypass the "
        "prefetch buffer and wait for a prefetch in progress; it draws no cycles.",
    )
    rptc_width: IntOption = choice(16, 8, question="How many bits of a location does RPT take?")

    # GPIO
    gpio_out_delay: IntOption = choice(
        1, 0, 2, question="How many cycles after the latch or the peripheral does an output pin change?"
    )

    # Timers and clocks
    timer_tif_point: TextOption = choice(
        "on_zero",
        "on_reload",
        question="Is TIF set on the step to zero, or with the reload one prescaler period later?",
        registers="TCR",
    )
    timer_late_tie: TextOption = choice(
        "requests",
        "waits_for_zero",
        question="Does setting TIE while TIF is still 1 request at once, as other peripherals do (section 8.1.1), or "
        "does only reaching zero request (Table 36)?",
        registers="TCR",
    )
    pll_lock_clock: TextOption = choice(
        "osc_div_4",
        "osc_div_2",
        question="What does the CPU run on while the PLL locks: the bypass clock of DIVSEL = 0, or OSCCLK/2?",
    )
    lspclk_phase: TextOption = choice(
        "free_running",
        "restart_on_write",
        question="Does a LOSPCP write leave the phase of the peripheral clock divider alone or restart it?",
        registers="LOSPCP",
    )
    wd_divider: TextOption = choice(
        "restarts_on_clear",
        "free_running",
        question="Does clearing WDCNTR also restart the divider before it, or is the next step up to one WDCLK early?",
        registers="WDCNTR",
    )
    wd_bad_key: TextOption = choice(
        "ignored",
        "reset",
        question="Does a wrong key in WDKEY do nothing (system guide) or reset at once (errata usage note)?",
        registers="WDKEY",
    )
