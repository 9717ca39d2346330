"""Undocumented behaviours of the SCI: one field per question, with the default answer first.

`SciOptions` has the answers for one `Sci`. It is built from a table of a case file (`core.options.options_from`) or
from keyword arguments.
"""

from __future__ import annotations

from ...core.options import Answers, BoolOption, IntOption, TextOption, choice, number


class SciOptions(Answers):
    """Answers for one SCI."""

    # Receiver, line side.
    rxrdy_point: TextOption = choice(
        "seven_eighths",
        "drawing",
        "stop_end",
        question="Where in the stop bit the character moves to SCIRXBUF; the drawing's 0.81 is taken as 6 of 8 SCICLK.",
        registers="SCIRXST",
    )
    rx_int_extra: IntOption = number(
        3,
        0,
        16,
        unit="SYSCLKOUT cycles",
        question="How long after RXRDY the receive interrupt reaches the PIE.",
        registers="SCIRXST",
    )
    stop_vote_samples: TextOption = choice(
        "4_5_6",
        "3_4_5",
        question="Which samples of the stop bit are voted on: guide's text or erratum's drawing.",
        registers="SCIRXST",
    )
    start_hunt_point: IntOption = choice(
        6,
        7,
        8,
        question="At which sub-sample of the stop bit the search for the next start bit opens.",
        registers="SCIRXST",
    )
    addrbit_hunt_with_parity: TextOption = choice(
        "address_bit",
        "parity_bit",
        question="In which bit the erratum's early search opens when a parity bit follows.",
        registers="SCIRXST",
    )
    break_bits: TextOption = choice(
        "10", "9.625", question="How many bit periods of 0 after a missing stop bit are a break.", registers="SCIRXST"
    )
    break_count_from: TextOption = choice(
        "last_stop_sample",
        "stop_end",
        question="From where the bit periods of a break are counted.",
        registers="SCIRXST",
    )
    rx_after_break: TextOption = choice(
        "blocked",
        "next_high",
        question="Whether reception after a break needs SW RESET or resumes when the line rises.",
        registers="SCIRXST",
    )
    rx_sync_stages: IntOption = choice(
        2, 0, 3, question="SYSCLKOUT cycles from the pin to the receiver's sampling.", registers="SCIRXST"
    )

    # Receiver, flags and buffer.
    break_char_delivered: BoolOption = choice(
        True,
        False,
        question="Whether a break's first frame (all zero, no stop bit) is loaded as a character.",
        registers="SCIFFRX SCIRXBUF",
    )
    brkdt_in_sleep: TextOption = choice(
        "set", "suppressed", question="Whether BRKDT is set while SLEEP = 1.", registers="SCIRXST"
    )
    error_flags_sticky: BoolOption = choice(
        True, False, question="Whether FE, OE and PE stay until SW RESET or follow each character.", registers="SCIRXST"
    )
    sleep_loads_buffer: BoolOption = choice(
        False,
        True,
        question="Whether characters that SLEEP hides still reach SCIRXBUF or the FIFO.",
        registers="SCIFFRX SCIRXBUF",
    )
    rxwake_idle_point: TextOption = choice(
        "tenth_bit",
        "next_character",
        question="When an idle line sets RXWAKE: after ten bits or with the next character.",
        registers="SCIRXST",
    )
    rxrdy_in_fifo_mode: TextOption = choice(
        "stays_0", "follows", question="Whether RXRDY follows RXFFST in FIFO mode.", registers="SCIRXST"
    )
    oe_in_fifo_mode: TextOption = choice(
        "overflow_only",
        "per_unread_word",
        question="Whether OE in FIFO mode needs a full FIFO or one unread word.",
        registers="SCIRXST",
    )
    fifo_overflow_drops: TextOption = choice(
        "oldest", "newest", question="Which word is lost when the receive FIFO is full.", registers="SCIFFRX SCIRXBUF"
    )
    rxffovf_interrupt: TextOption = choice(
        "none", "rxffiena", question="Whether RXFFOVF requests RXINT through RXFFIENA.", registers="SCIFFRX"
    )
    rxerr_int_mode: TextOption = choice(
        "rising",
        "every_error",
        question="Whether only RXERROR rising requests RXINT or every further error too.",
        registers="SCIRXST",
    )
    rxfifo_read_when_empty: TextOption = choice(
        "last_word", "zero", question="What SCIRXBUF reads while the FIFO is empty.", registers="SCIFFRX SCIRXBUF"
    )

    # FIFO interrupts of both directions.
    fifo_int_mode: TextOption = choice(
        "level",
        "edge",
        question="Whether a FIFO interrupt flag is set again at once when cleared with its condition true.",
        registers="SCIFFRX SCIFFTX",
    )

    # Transmitter.
    txfifo_write_when_full: TextOption = choice(
        "ignored",
        "overwrites_last",
        question="What a SCITXBUF write does to a full transmit FIFO.",
        registers="SCIFFTX SCITXBUF",
    )
    txrdy_point: TextOption = choice(
        "start_edge",
        "next_lspclk",
        question="When an idle transmitter takes a written character into TXSHF.",
        registers="SCICTL2 SCITXBUF",
    )
    tx_reload_point: TextOption = choice(
        "stop_end",
        "stop_begin",
        question="Where in the stop bit a waiting character moves to TXSHF (standard mode).",
        registers="SCICTL2 SCITXBUF",
    )
    txempty_fall: TextOption = choice(
        "write",
        "halfway",
        question="When TXEMPTY falls: with the write or halfway to the start bit.",
        registers="SCICTL2",
    )
    txbuf_write_when_full: TextOption = choice(
        "replaces",
        "ignored",
        question="What a SCITXBUF write does to a character still waiting there.",
        registers="SCITXBUF",
    )
    tx_phase: TextOption = choice(
        "next_sciclk",
        "next_bit_tick",
        "restart",
        question="Where a start bit after idle begins: next SCICLK, next eighth SCICLK, or divider restarted.",
        registers="SCITXBUF",
    )
    txena_clear_drains: TextOption = choice(
        "all_written",
        "current_only",
        question="What is still sent after TXENA was cleared.",
        registers="SCICTL1 SCITXBUF",
    )
    txwake_idle_len: TextOption = choice(
        "11_bits", "one_frame", question="How long the idle time sent for TXWAKE is.", registers="SCICTL1"
    )
    parity_of_short_chars: TextOption = choice(
        "masked",
        "whole_byte",
        question="Whether SCITXBUF bits above the character's length count in the parity sent.",
        registers="SCICCR SCITXBUF",
    )
    fftxdly_first_word: TextOption = choice(
        "no_delay",
        "delay",
        question="Whether FFTXDLY also precedes a word written to an idle FIFO.",
        registers="SCIFFCT",
    )
    fftxdly_max: IntOption = choice(255, 256, question="How many periods FFTXDLY = 255 means.", registers="SCIFFCT")
    fftxdly_unit: TextOption = choice(
        "bit", "sciclk", question="Whether FFTXDLY counts bits or SCICLK periods.", registers="SCIFFCT"
    )

    # Resets.
    swreset_fifo_effect: TextOption = choice(
        "untouched",
        "cleared",
        question="What SW RESET = 0 does to FIFO counters and their flags.",
        registers="SCIFFRX SCIFFTX",
    )
    txbuf_write_in_swreset: TextOption = choice(
        "lost",
        "sent_after_release",
        question="What happens to a SCITXBUF write while SW RESET = 0.",
        registers="SCITXBUF",
    )
    scirst_scope: TextOption = choice(
        "shifters_and_fifos",
        "shifters",
        question="Whether SCIRST = 0 also empties the FIFOs and clears their flags.",
        registers="SCIFFRX SCIFFTX",
    )

    # Rate and format.
    autobaud_brr_rule: TextOption = choice(
        "nearest",
        "truncated",
        question="How the measured bit length becomes the baud divider.",
        registers="SCIHBAUD SCILBAUD",
    )
    brr_write_effect: TextOption = choice(
        "next_reload",
        "at_once",
        question="When a baud divider write reaches a running divider.",
        registers="SCIHBAUD SCILBAUD",
    )
    format_write_effect: TextOption = choice(
        "next_character", "at_once", question="What a SCICCR write does to a character under way.", registers="SCICCR"
    )

    # Other questions.
    clock_gate_access: TextOption = choice(
        "reads_0", "accessible", question="What a CPU access does while the module's clock is off."
    )
    idle_before_first_frame: BoolOption = choice(
        True,
        False,
        question="Whether ten idle bits after SW RESET, before any frame, also begin a block.",
        registers="SCIRXST",
    )
    txrdy_in_fifo_mode: TextOption = choice(
        "stays_1",
        "follows_fifo",
        question="Whether TXRDY in FIFO mode is 0 while words wait in the FIFO.",
        registers="SCICTL2",
    )
