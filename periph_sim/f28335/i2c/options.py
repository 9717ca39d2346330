"""Undocumented behaviours of the I2C module as named options, each with its default and its other values.

Each option has its question and, if it concerns registers, their names. Times are in module clocks (IPSC + 1 cycles
of SYSCLKOUT) or SYSCLKOUT cycles, according to the unit.

The default of `dxr_to_xsr_copy_point` agrees with an observation on silicon: a routine that waits for SDIR before its
first I2CDXR write sent every byte correctly, and the same routine without the wait did not. With the default
`rrdy_point`, only `any_ack_fall9` (the default) and `eager_reloaded_at_address` reproduce both results.
"""

from __future__ import annotations

from ...core.options import Answers, BoolOption, IntOption, TextOption, choice, number


class I2cOptions(Answers):
    # Slave-transmitter path
    emdr_present: BoolOption = choice(
        True, False, question="Does the chip have I2CEMDR? Without it BCM = 1 holds.", registers="I2CEMDR"
    )
    bcm_reset: IntOption = choice(1, 0, question="Reset value of I2CEMDR.BCM.", registers="I2CEMDR")
    aas_sdir_point: TextOption = choice(
        "fall8", "rise8", "fall9", question="SCL edge of the address byte that sets AAS, SDIR.", registers="I2CSTR"
    )
    dxr_to_xsr_copy_point: TextOption = choice(
        "any_ack_fall9",
        "ack_fall9",
        "ack_rise9",
        "eager",
        "eager_if_trx",
        "eager_reloaded_at_address",
        question="When I2CDXR is copied to I2CXSR as slave: at the end of any acknowledged byte, of one that requests "
        "data, at that acknowledge's rise, at once, at once with TRX = 1, or at once and again at the read address.",
        registers="I2CDXR I2CSTR",
    )
    xrdy_rise_point: TextOption = choice(
        "fall9", "at_copy", question="When XRDY rises for a copy inside an ACK slot.", registers="I2CDXR I2CSTR"
    )
    xrdyint_when_idle: TextOption = choice(
        "level",
        "only_addressed",
        question="Does XRDY = 1 with its enable request at once, or only while data are needed?",
        registers="I2CISRC",
    )
    tx_underflow_policy: TextOption = choice(
        "stretch",
        "resend_previous",
        "send_ones",
        question="What a slave-transmitter without data does (BCM = 1).",
        registers="I2CDXR",
    )
    stretch_after_address_ack: BoolOption = choice(
        True, False, question="Does it stretch before the first byte, or send what I2CXSR held?", registers="I2CDXR"
    )
    xsmt_rule: TextOption = choice(
        "text",
        "figure",
        question="BCM = 0: XSMT is 0 from underflow to the write, or from the write to the copy.",
        registers="I2CSTR",
    )
    stale_byte_next_read: TextOption = choice(
        "sent_first",
        "discarded",
        question="What happens to a byte left in I2CDXR at the next read?",
        registers="I2CDXR",
    )
    dxr_write_while_full: TextOption = choice(
        "overwrite", "ignored", "queued_behind_xsr", question="A write to I2CDXR while XRDY = 0.", registers="I2CDXR"
    )
    dxr_survives_irs: TextOption = choice(
        "data_kept_xrdy_1",
        "kept_and_still_sent",
        question="After IRS = 0: is the byte in I2CDXR still sent?",
        registers="I2CDXR",
    )
    nack_clears_dxr: BoolOption = choice(
        False, True, question="Does the master's NACK empty I2CDXR?", registers="I2CDXR I2CSTR"
    )
    xsmt_on_final_nack: TextOption = choice(
        "stays_1", "0_without_stretch", question="XSMT after a NACK with I2CDXR empty.", registers="I2CSTR"
    )
    nackint_in_slave_tx: BoolOption = choice(
        True, False, question="Does a NACK as slave-transmitter request an interrupt?", registers="I2CISRC"
    )
    sda_setup_before_scl_release: IntOption = number(
        1, 0, 255, unit="module clocks", question="From SDA valid to the release of a stretched SCL."
    )
    sdir_clear: TextOption = choice(
        "any_start_or_stop",
        "until_next_address",
        question="What clears SDIR besides software and reset?",
        registers="I2CSTR",
    )
    cnt_in_slave_tx: TextOption = choice(
        "no_effect",
        "counts_bytes",
        question="Does I2CCNT end the data of a slave-transmitter? (Then ones follow.)",
        registers="I2CCNT",
    )
    irs_write1_releases_bus: BoolOption = choice(
        False, True, question="Does IRS = 1 written over 1 end a stretch as slave?", registers="I2CMDR"
    )

    # Receiver
    rrdy_point: TextOption = choice(
        "fall8", "rise9", "fall9", question="SCL edge at which I2CRSR is copied to I2CDRR.", registers="I2CDRR I2CSTR"
    )
    rx_overrun_policy: TextOption = choice(
        "stretch_after_second_byte",
        "nack",
        "overwrite",
        question="A slave-receiver's second unread byte.",
        registers="I2CDRR I2CSTR",
    )
    rsfull_stretch_point: TextOption = choice(
        "after_fall9",
        "before_ack",
        question="Where the stretch for the second unread byte begins.",
        registers="I2CDRR I2CSTR",
    )
    rrdy_clear_reads_drr: BoolOption = choice(
        True,
        False,
        question="Is I2CDRR read for the overrun logic once RRDY was cleared by writing 1?",
        registers="I2CDRR I2CSTR",
    )
    mr_nack_at_count0: TextOption = choice(
        "always",
        "only_with_stp",
        question="Is a master-receiver's last byte answered NACK with STP = 0 too?",
        registers="I2CCNT I2CMDR",
    )
    rm_receiver: TextOption = choice(
        "allowed", "ignored", question="Does repeat mode exist for a master-receiver?", registers="I2CMDR"
    )
    bc_less_than_8_upper_bits: TextOption = choice(
        "last_bits", "zeros", question="Bits above BC in I2CDRR: earlier bits on the bus, or 0.", registers="I2CDRR"
    )
    nackmod_on_address: TextOption = choice(
        "data_only",
        "address_too",
        question="Does NACKMOD also answer an address with NACK? (Not in the project's list.)",
        registers="I2CMDR",
    )

    # Bus state, addresses
    bb_on_irs_reset: TextOption = choice("keep", "clear", question="BB when IRS is written 0.", registers="I2CSTR")
    oar_latch: TextOption = choice(
        "live", "at_irs", "at_start", question="When a new I2COAR takes effect.", registers="I2COAR"
    )
    general_call: TextOption = choice(
        "acknowledged", "ignored", question="Is address 0 always answered?", registers="I2CSTR"
    )
    scd_foreign: TextOption = choice("every_stop", "own_transfers", question="Which STOPs set SCD?", registers="I2CSTR")
    start_byte_ad0: TextOption = choice("stays_0", "set", question="Does a START byte set AD0?", registers="I2CSTR")
    oar_zero: TextOption = choice(
        "general_call_only", "own_address_too", question="I2COAR = 0: is 0x01 answered?", registers="I2COAR"
    )
    own_general_call: TextOption = choice(
        "not_answered", "answered", question="Does a master answer its own general call?", registers="I2CSTR"
    )
    aas_fdf_point: TextOption = choice(
        "end_of_byte", "ack", question="Free data format: when AAS is set.", registers="I2CSTR"
    )

    # Interrupts
    isrc_read_clears_aas: BoolOption = choice(
        False, True, question="Does a read of I2CISRC = 7 clear AAS?", registers="I2CISRC I2CSTR"
    )
    xrdy_w1c: TextOption = choice("no", "yes", question="Can XRDY be cleared by writing 1?", registers="I2CSTR")
    int_line: TextOption = choice(
        "pulse", "level", question="I2CINT1A: a pulse per code, or held while INTCODE is not 0.", registers="I2CISRC"
    )
    event_to_isrc_delay: IntOption = number(
        2, 0, 64, unit="SYSCLKOUT cycles", question="From an event to its code and request.", registers="I2CISRC"
    )
    int_priority: TextOption = choice("ascending", "descending", question="Which code goes first.", registers="I2CISRC")
    isrc_preempt: TextOption = choice(
        "highest", "first_come", question="May a later event of higher rank replace a code?", registers="I2CISRC"
    )
    isrc_follows_flag: TextOption = choice(
        "stays", "vanishes", question="A code whose flag is cleared in another way.", registers="I2CISRC"
    )
    irs_clears_commands: BoolOption = choice(
        True, False, question="Does IRS = 0 clear STT, STP and NACKMOD?", registers="I2CMDR"
    )
    irs_clears_isrc: BoolOption = choice(True, False, question="Does IRS = 0 clear INTCODE?", registers="I2CISRC")

    # Master
    ardy_on_nack: BoolOption = choice(True, False, question="Does a NACK set ARDY?", registers="I2CSTR")
    hold_scl_after_nack: BoolOption = choice(
        True, False, question="Is SCL held low after a NACK, until STP or STT?", registers="I2CMDR"
    )
    cnt_copy_point: TextOption = choice(
        "start", "write", question="When I2CCNT goes to the internal counter.", registers="I2CCNT"
    )
    stt_while_busy: TextOption = choice(
        "foreign_al",
        "foreign_waits",
        "always_repeated_start",
        question="STT while another master has the bus.",
        registers="I2CMDR I2CSTR",
    )
    foreign_start_stop: TextOption = choice(
        "unnoticed",
        "loses_arbitration",
        question="A START or STOP of others in the middle of a transfer as master: do bits and clock go on, or is "
        "arbitration lost?",
        registers="I2CMDR I2CSTR",
    )
    al_clears_stt: BoolOption = choice(True, False, question="Does lost arbitration clear STT?", registers="I2CMDR")
    stop_without_data: TextOption = choice(
        "address_counts", "waits_for_data", question="RM = 0: does an address byte allow a STOP?", registers="I2CMDR"
    )
    ten_bit_read: TextOption = choice(
        "header_r_only",
        "full_address_first",
        question="XA = 1, TRX = 0 from idle: header with R, or the whole address.",
        registers="I2CMDR I2CSAR",
    )
    stt_with_irs_write: TextOption = choice(
        "accepted", "dropped", question="STT, STP in the write that sets IRS.", registers="I2CMDR"
    )
    scl_sync_cycles: IntOption = number(
        0, 0, 16, unit="module clocks", question="Extra wait after a stretched SCL rises; 0: d includes it."
    )
    dlb_delay: TextOption = choice(
        "after_last_bit",
        "after_dxr_write",
        question="Loopback: the event from which the delay n counts.",
        registers="I2CMDR",
    )

    # Noise filter, clock, debugger halt, FIFO
    noise_filter_cycles: IntOption = number(
        1, 0, 4096, unit="module clocks", question="How long a level must last on a pin to be seen."
    )
    unequal_arrival: TextOption = choice(
        "in_order",
        "one_sample",
        question="Edges of SCL and SDA less than a module clock apart: does each pass the noise filter by itself, "
        "or do both leave it together, with the later one?",
    )
    psc_write_irs1: TextOption = choice(
        "stored", "dropped", question="A write to I2CPSC while IRS = 1.", registers="I2CPSC"
    )
    clock_gate_access: TextOption = choice(
        "reads_0", "accessible", question="Register access while the clock is gated off."
    )
    free_slave_unit: TextOption = choice(
        "byte", "whole_transfer", question="FREE = 0: the unit that a slave still completes.", registers="I2CMDR"
    )
    fifo_int_mode: TextOption = choice(
        "level", "edge", question="Does a FIFO flag set again while its condition holds?", registers="I2CFFRX I2CFFTX"
    )
    fifo_17th_byte: TextOption = choice(
        "stretch", "nack", "overwrite", question="One byte more than the RX FIFO can hold.", registers="I2CDRR I2CFFRX"
    )
    txfifo_reset_flushes_xsr: BoolOption = choice(
        False, True, question="Does TXFFRST = 0 drop a byte already in I2CXSR?", registers="I2CDXR I2CFFTX"
    )
    fifo_extra_stage: TextOption = choice(
        "no", "dxr_drr_behind", question="Are I2CDXR and I2CDRR stages besides the FIFOs?", registers="I2CFFRX I2CFFTX"
    )
    irs_clears_fifo: BoolOption = choice(
        False, True, question="Does IRS = 0 empty the FIFOs?", registers="I2CFFRX I2CFFTX"
    )
