"""Open questions about the SPI: one field for each, with the default answer first.

`SpiOptions` has the answers for one `Spi`. It is built from a table of a case file (`core.options.options_from`) or
from keyword arguments.
"""

from __future__ import annotations

from ...core.options import Answers, BoolOption, IntOption, TextOption, choice, number


class SpiOptions(Answers):
    """Answers to questions that SPRUEU3 and the data sheet SPRS439 leave open or answer in two ways."""

    # Transfers of a master.
    start_point: TextOption = choice(
        "next_lspclk",
        "bit_clock",
        question="When an idle master begins: with the next LSPCLK edge or with a bit clock that always runs.",
        registers="SPITXBUF",
    )
    ste_lead: TextOption = choice(
        "half_bit",
        "three_half_bits",
        question="How long before the first edge of SPICLK SPISTE falls; the data sheet's minimum is half a period.",
    )
    ste_in_txdly: TextOption = choice(
        "low", "high", question="Whether SPISTE stays low between words that TXDLY keeps apart.", registers="SPIFFCT"
    )
    txdly_first_word: TextOption = choice(
        "no_delay", "delay", question="Whether TXDLY also precedes a word written to an idle FIFO.", registers="SPIFFCT"
    )

    # Flags and interrupts.
    int_flag_point: TextOption = choice(
        "trailing_edge",
        "latch_edge",
        question="With CLK_PHASE = 1: whether a character is complete at the last edge of SPICLK or with its last bit.",
        registers="SPISTS",
    )
    int_request: TextOption = choice(
        "flag_rises",
        "every_character",
        question="Whether RXINT is requested again while INT_FLAG is still set.",
        registers="SPISTS",
    )
    status_in_fifo_mode: TextOption = choice(
        "stays_0", "follows", question="Whether INT_FLAG and OVERRUN_FLAG are set in FIFO mode.", registers="SPISTS"
    )
    fifo_int_mode: TextOption = choice(
        "level",
        "edge",
        question="Whether a FIFO interrupt flag is set again at once when cleared with its condition true.",
        registers="SPIFFRX SPIFFTX",
    )
    rxffovf_interrupt: TextOption = choice(
        "rxffiena",
        "none",
        question="Whether RXFFOVF requests RXINT through RXFFIENA: section 1.5 says so, table 1-5 has no such line.",
        registers="SPIFFRX",
    )

    # Buffers.
    txbuf_write_when_full: TextOption = choice(
        "replaces",
        "ignored",
        question="What a SPITXBUF write does to a character still waiting there.",
        registers="SPITXBUF",
    )
    txfifo_write_when_full: TextOption = choice(
        "ignored",
        "overwrites_last",
        question="What a SPITXBUF write does to a full transmit FIFO.",
        registers="SPIFFTX SPITXBUF",
    )
    rxfifo_read_when_empty: TextOption = choice(
        "last_word", "zero", question="What SPIRXBUF reads while the FIFO is empty.", registers="SPIFFRX SPIRXBUF"
    )

    # Slave.
    input_latency: IntOption = number(
        0, 0, 16, unit="SYSCLKOUT cycles", question="How long an input takes from the module's edge to its effect."
    )
    ste_high_mid_character: TextOption = choice(
        "keeps_count",
        "restarts",
        question="Whether SPISTE that rises within a character resets the slave's bit counter.",
    )

    # Resets, debugger, clock gate.
    swreset_clears_fifos: BoolOption = choice(
        False,
        True,
        question="Whether SW RESET = 0 empties the FIFOs and clears their flags.",
        registers="SPIFFRX SPIFFTX",
    )
    spirst_clears_fifos: BoolOption = choice(
        True,
        False,
        question="Whether SPIRST = 0 empties the FIFOs and clears their flags.",
        registers="SPIFFRX SPIFFTX",
    )
    bits_after_suspend: TextOption = choice(
        "whole_character",
        "remainder",
        question="How many bits follow a stop within a character: section 2.1.10 names both and shows the first.",
    )
    clock_gate_access: TextOption = choice(
        "reads_0", "accessible", question="What a CPU access does while the module's clock is off."
    )
