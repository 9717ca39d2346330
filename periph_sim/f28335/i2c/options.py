"""Undocumented behaviours of the I2C module as named options, each with its default and its other values.

Each option has its question, the registers that it concerns and an experiment on hardware that would decide it. Times
are in module clocks (IPSC + 1 cycles of SYSCLKOUT) or SYSCLKOUT cycles, according to the unit.

The default of `dxr_to_xsr_copy_point` agrees with an observation on silicon: a routine that waits for SDIR before its
first I2CDXR write sent every byte correctly, and the same routine without the wait did not. With the default
`rrdy_point`, only `any_ack_fall9` (the default) and `eager_reloaded_at_address` reproduce both results.
"""

from __future__ import annotations

from ...core.options import Answers, BoolOption, IntOption, TextOption, choice, number


class I2cOptions(Answers):
    # Slave-transmitter path
    emdr_present: BoolOption = choice(
        True,
        False,
        question="Does the chip have I2CEMDR? Without it BCM = 1 holds.",
        registers="I2CEMDR",
        experiment="Write 0, then 1, to 0x790B, and read both back.",
    )
    bcm_reset: IntOption = choice(
        1, 0, question="Reset value of I2CEMDR.BCM.", registers="I2CEMDR", experiment="Read 0x790B after a reset."
    )
    aas_sdir_point: TextOption = choice(
        "fall8",
        "rise8",
        "fall9",
        question="SCL edge of the address byte that sets AAS, SDIR.",
        registers="I2CSTR",
        experiment="Step SCL by hand through the address byte, and read I2CSTR after each edge.",
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
        experiment="Write I2CDXR on an idle bus and read XRDY: 1 means eager. Then write I2CDXR between the ninth rise "
        "and fall of SCL, and see which byte is sent.",
    )
    xrdy_rise_point: TextOption = choice(
        "fall9",
        "at_copy",
        question="When XRDY rises for a copy inside an ACK slot.",
        registers="I2CDXR I2CSTR",
        experiment="Write I2CDXR between the ninth rise and fall of SCL, and read I2CSTR until XRDY rises.",
    )
    xrdyint_when_idle: TextOption = choice(
        "level",
        "only_addressed",
        question="Does XRDY = 1 with its enable request at once, or only while data are needed?",
        registers="I2CISRC",
        experiment="Set I2CIER.XRDY on an idle bus, and see whether I2CISRC becomes 5.",
    )
    tx_underflow_policy: TextOption = choice(
        "stretch",
        "resend_previous",
        "send_ones",
        question="What a slave-transmitter without data does (BCM = 1).",
        registers="I2CDXR",
        experiment="Leave a byte of a read unserviced, and watch SCL and SDA.",
    )
    stretch_after_address_ack: BoolOption = choice(
        True,
        False,
        question="Does it stretch before the first byte, or send what I2CXSR held?",
        registers="I2CDXR",
        experiment="Leave the first byte of a read unserviced, and watch SCL and SDA.",
    )
    xsmt_rule: TextOption = choice(
        "text",
        "figure",
        question="BCM = 0: XSMT is 0 from underflow to the write, or from the write to the copy.",
        registers="I2CSTR",
        experiment="Read I2CSTR again and again while SCL is stretched.",
    )
    stale_byte_next_read: TextOption = choice(
        "sent_first",
        "discarded",
        question="What happens to a byte left in I2CDXR at the next read?",
        registers="I2CDXR",
        experiment="Let the firmware send a counter, read one byte twice, and compare.",
    )
    dxr_write_while_full: TextOption = choice(
        "overwrite",
        "ignored",
        "queued_behind_xsr",
        question="A write to I2CDXR while XRDY = 0.",
        registers="I2CDXR",
        experiment="Write 0x11, then 0x22, to I2CDXR on an idle bus, and read two bytes.",
    )
    dxr_survives_irs: TextOption = choice(
        "data_kept_xrdy_1",
        "kept_and_still_sent",
        question="After IRS = 0: is the byte in I2CDXR still sent?",
        registers="I2CDXR",
        experiment="Write I2CDXR, write IRS = 0 and 1, and read a byte that the firmware does not service.",
    )
    nack_clears_dxr: BoolOption = choice(
        False,
        True,
        question="Does the master's NACK empty I2CDXR?",
        registers="I2CDXR I2CSTR",
        experiment="Let the firmware send a counter, read one byte twice, and compare.",
    )
    xsmt_on_final_nack: TextOption = choice(
        "stays_1",
        "0_without_stretch",
        question="XSMT after a NACK with I2CDXR empty.",
        registers="I2CSTR",
        experiment="Read I2CSTR after a final NACK with I2CDXR empty.",
    )
    nackint_in_slave_tx: BoolOption = choice(
        True,
        False,
        question="Does a NACK as slave-transmitter request an interrupt?",
        registers="I2CISRC",
        experiment="Enable only the NACK interrupt, and end a read with NACK.",
    )
    sda_setup_before_scl_release: IntOption = number(
        1,
        0,
        255,
        unit="module clocks",
        question="From SDA valid to the release of a stretched SCL.",
        experiment="Measure the time from SDA to the rise of SCL at the end of a stretch.",
    )
    sdir_clear: TextOption = choice(
        "any_start_or_stop",
        "until_next_address",
        question="What clears SDIR besides software and reset?",
        registers="I2CSTR",
        experiment="Read I2CSTR after the STOP of a read.",
    )
    cnt_in_slave_tx: TextOption = choice(
        "no_effect",
        "counts_bytes",
        question="Does I2CCNT end the data of a slave-transmitter? (Then ones follow.)",
        registers="I2CCNT",
        experiment="Set I2CCNT = 1 as slave, and read three bytes.",
    )
    irs_write1_releases_bus: BoolOption = choice(
        False,
        True,
        question="Does IRS = 1 written over 1 end a stretch as slave?",
        registers="I2CMDR",
        experiment="Let the slave stretch, write IRS = 1 without a 0 before, and watch SCL.",
    )

    # Receiver
    rrdy_point: TextOption = choice(
        "fall8",
        "rise9",
        "fall9",
        question="SCL edge at which I2CRSR is copied to I2CDRR.",
        registers="I2CDRR I2CSTR",
        experiment="Step SCL by hand through a received byte, and read I2CSTR after each edge.",
    )
    rx_overrun_policy: TextOption = choice(
        "stretch_after_second_byte",
        "nack",
        "overwrite",
        question="A slave-receiver's second unread byte.",
        registers="I2CDRR I2CSTR",
        experiment="Send bytes that the firmware does not read, and watch SCL and the ACK bit.",
    )
    rsfull_stretch_point: TextOption = choice(
        "after_fall9",
        "before_ack",
        question="Where the stretch for the second unread byte begins.",
        registers="I2CDRR I2CSTR",
        experiment="Send bytes that the firmware does not read, and see on which side of the ACK bit SCL stays low.",
    )
    rrdy_clear_reads_drr: BoolOption = choice(
        True,
        False,
        question="Is I2CDRR read for the overrun logic once RRDY was cleared by writing 1?",
        registers="I2CDRR I2CSTR",
        experiment="Clear RRDY by writing 1 after each byte without reading I2CDRR, send more bytes, and watch SCL.",
    )
    mr_nack_at_count0: TextOption = choice(
        "always",
        "only_with_stp",
        question="Is a master-receiver's last byte answered NACK with STP = 0 too?",
        registers="I2CCNT I2CMDR",
        experiment="Read as master with STP = 0, and watch the last ACK bit.",
    )
    rm_receiver: TextOption = choice(
        "allowed",
        "ignored",
        question="Does repeat mode exist for a master-receiver?",
        registers="I2CMDR",
        experiment="Read as master in repeat mode, and count the bytes.",
    )
    bc_less_than_8_upper_bits: TextOption = choice(
        "last_bits",
        "zeros",
        question="Bits above BC in I2CDRR: earlier bits on the bus, or 0.",
        registers="I2CDRR",
        experiment="Receive fewer than eight bits, and read I2CDRR.",
    )
    nackmod_on_address: TextOption = choice(
        "data_only",
        "address_too",
        question="Does NACKMOD also answer an address with NACK? (Not in the project's list.)",
        registers="I2CMDR",
        experiment="Set NACKMOD before an address byte, and watch its ACK bit.",
    )

    # Bus state, addresses
    bb_on_irs_reset: TextOption = choice(
        "keep",
        "clear",
        question="BB when IRS is written 0.",
        registers="I2CSTR",
        experiment="Write IRS = 0 and 1 after a START, and read BB.",
    )
    oar_latch: TextOption = choice(
        "live",
        "at_irs",
        "at_start",
        question="When a new I2COAR takes effect.",
        registers="I2COAR",
        experiment="Change I2COAR within an address byte, and see which address is answered.",
    )
    general_call: TextOption = choice(
        "acknowledged",
        "ignored",
        question="Is address 0 always answered?",
        registers="I2CSTR",
        experiment="Send address 0, and watch its ACK bit.",
    )
    scd_foreign: TextOption = choice(
        "every_stop",
        "own_transfers",
        question="Which STOPs set SCD?",
        registers="I2CSTR",
        experiment="Read SCD after a transfer to another address.",
    )
    start_byte_ad0: TextOption = choice(
        "stays_0",
        "set",
        question="Does a START byte set AD0?",
        registers="I2CSTR",
        experiment="Send 0x01, and read AD0.",
    )
    oar_zero: TextOption = choice(
        "general_call_only",
        "own_address_too",
        question="I2COAR = 0: is 0x01 answered?",
        registers="I2COAR",
        experiment="Send 0x01 and 0x00 with I2COAR = 0, and watch the ACK bits.",
    )
    own_general_call: TextOption = choice(
        "not_answered",
        "answered",
        question="Does a master answer its own general call?",
        registers="I2CSTR",
        experiment="Send a general call as the only module on the bus, and watch its ACK bit.",
    )
    aas_fdf_point: TextOption = choice(
        "end_of_byte",
        "ack",
        question="Free data format: when AAS is set.",
        registers="I2CSTR",
        experiment="Step SCL by hand through the first byte in free data format, and read I2CSTR after each edge.",
    )

    # Interrupts
    isrc_read_clears_aas: BoolOption = choice(
        False,
        True,
        question="Does a read of I2CISRC = 7 clear AAS?",
        registers="I2CISRC I2CSTR",
        experiment="Read I2CISRC = 7 within a transfer, and then I2CSTR.",
    )
    xrdy_w1c: TextOption = choice(
        "no",
        "yes",
        question="Can XRDY be cleared by writing 1?",
        registers="I2CSTR",
        experiment="Write 0x0010 to I2CSTR with XRDY = 1, and read it back.",
    )
    int_line: TextOption = choice(
        "pulse",
        "level",
        question="I2CINT1A: a pulse per code, or held while INTCODE is not 0.",
        registers="I2CISRC",
        experiment="Use a service routine that does not read I2CISRC, and count its entries.",
    )
    event_to_isrc_delay: IntOption = number(
        2,
        0,
        64,
        unit="SYSCLKOUT cycles",
        question="From an event to its code and request.",
        registers="I2CISRC",
        experiment="Toggle a pin in the service routine, and measure from the edge of SCL, less the interrupt latency.",
    )
    int_priority: TextOption = choice(
        "ascending",
        "descending",
        question="Which code goes first.",
        registers="I2CISRC",
        experiment="Let two flags wait, and read I2CISRC twice.",
    )
    isrc_preempt: TextOption = choice(
        "highest",
        "first_come",
        question="May a later event of higher rank replace a code?",
        registers="I2CISRC",
        experiment="Leave the code of RRDY unread, provoke a NACK, and read I2CISRC.",
    )
    isrc_follows_flag: TextOption = choice(
        "stays",
        "vanishes",
        question="A code whose flag is cleared in another way.",
        registers="I2CISRC",
        experiment="Read I2CDRR before I2CISRC.",
    )
    irs_clears_commands: BoolOption = choice(
        True,
        False,
        question="Does IRS = 0 clear STT, STP and NACKMOD?",
        registers="I2CMDR",
        experiment="Set STT, STP and NACKMOD, write IRS = 0, and read I2CMDR.",
    )
    irs_clears_isrc: BoolOption = choice(
        True,
        False,
        question="Does IRS = 0 clear INTCODE?",
        registers="I2CISRC",
        experiment="Write IRS = 0 and 1 with a code waiting, and read I2CISRC.",
    )

    # Master
    ardy_on_nack: BoolOption = choice(
        True,
        False,
        question="Does a NACK set ARDY?",
        registers="I2CSTR",
        experiment="Address an absent slave as master, and read ARDY.",
    )
    hold_scl_after_nack: BoolOption = choice(
        True,
        False,
        question="Is SCL held low after a NACK, until STP or STT?",
        registers="I2CMDR",
        experiment="Address an absent slave as master, and watch SCL.",
    )
    cnt_copy_point: TextOption = choice(
        "start",
        "write",
        question="When I2CCNT goes to the internal counter.",
        registers="I2CCNT",
        experiment="Change I2CCNT within a transfer as master, and count the bytes.",
    )
    stt_while_busy: TextOption = choice(
        "foreign_al",
        "foreign_waits",
        "always_repeated_start",
        question="STT while another master has the bus.",
        registers="I2CMDR I2CSTR",
        experiment="Set STT during a transfer of another master.",
    )
    foreign_start_stop: TextOption = choice(
        "unnoticed",
        "loses_arbitration",
        question="A START or STOP of others in the middle of a transfer as master: do bits and clock go on, or is "
        "arbitration lost?",
        registers="I2CMDR I2CSTR",
        experiment="Force a START within a byte sent as master, and read AL.",
    )
    al_clears_stt: BoolOption = choice(
        True,
        False,
        question="Does lost arbitration clear STT?",
        registers="I2CMDR",
        experiment="Force a lost arbitration before the START, and read I2CMDR.",
    )
    stop_without_data: TextOption = choice(
        "address_counts",
        "waits_for_data",
        question="RM = 0: does an address byte allow a STOP?",
        registers="I2CMDR",
        experiment="Set STP after an address that was answered NACK, and watch for the STOP.",
    )
    ten_bit_read: TextOption = choice(
        "header_r_only",
        "full_address_first",
        question="XA = 1, TRX = 0 from idle: header with R, or the whole address.",
        registers="I2CMDR I2CSAR",
        experiment="Set STT with XA = 1 and TRX = 0 on an idle bus, and decode the address bytes.",
    )
    stt_with_irs_write: TextOption = choice(
        "accepted",
        "dropped",
        question="STT, STP in the write that sets IRS.",
        registers="I2CMDR",
        experiment="Write I2CMDR = 0x2620 after a reset, and watch for the START.",
    )
    scl_sync_cycles: IntOption = number(
        0,
        0,
        16,
        unit="module clocks",
        question="Extra wait after a stretched SCL rises; 0: d includes it.",
        experiment="Compare the period of SCL with I2CCLKL and I2CCLKH while edges are slow.",
    )
    dlb_delay: TextOption = choice(
        "after_last_bit",
        "after_dxr_write",
        question="Loopback: the event from which the delay n counts.",
        registers="I2CMDR",
        experiment="Measure from the I2CDXR write to RRDY in loopback.",
    )

    # Noise filter, clock, debugger halt, FIFO
    noise_filter_cycles: IntOption = number(
        1,
        0,
        4096,
        unit="module clocks",
        question="How long a level must last on a pin to be seen.",
        experiment="Send pulses of growing width with a generator, or measure from an edge to its flag.",
    )
    unequal_arrival: TextOption = choice(
        "in_order",
        "one_sample",
        question="Edges of SCL and SDA less than a module clock apart: does each pass the noise filter by itself, "
        "or do both leave it together, with the later one?",
        experiment="Change SCL and SDA a fraction of a module clock apart, and read BB.",
    )
    psc_write_irs1: TextOption = choice(
        "stored",
        "dropped",
        question="A write to I2CPSC while IRS = 1.",
        registers="I2CPSC",
        experiment="Write I2CPSC with IRS = 1, read it back, write IRS = 0 and 1, and measure SCL.",
    )
    clock_gate_access: TextOption = choice(
        "reads_0",
        "accessible",
        question="Register access while the clock is gated off.",
        experiment="Read a register with I2CAENCLK = 0.",
    )
    free_slave_unit: TextOption = choice(
        "byte",
        "whole_transfer",
        question="FREE = 0: the unit that a slave still completes.",
        registers="I2CMDR",
        experiment="Stop at a breakpoint within a transfer, and see when the slave stops.",
    )
    fifo_int_mode: TextOption = choice(
        "level",
        "edge",
        question="Does a FIFO flag set again while its condition holds?",
        registers="I2CFFRX I2CFFTX",
        experiment="Clear TXFFINT while TXFFST = 0, and read it back.",
    )
    fifo_17th_byte: TextOption = choice(
        "stretch",
        "nack",
        "overwrite",
        question="One byte more than the RX FIFO can hold.",
        registers="I2CDRR I2CFFRX",
        experiment="Send 18 bytes that the firmware does not read, and watch SCL and the ACK bit.",
    )
    txfifo_reset_flushes_xsr: BoolOption = choice(
        False,
        True,
        question="Does TXFFRST = 0 drop a byte already in I2CXSR?",
        registers="I2CDXR I2CFFTX",
        experiment="Reset the TX FIFO after a read, and read again.",
    )
    fifo_extra_stage: TextOption = choice(
        "no",
        "dxr_drr_behind",
        question="Are I2CDXR and I2CDRR stages besides the FIFOs?",
        registers="I2CFFRX I2CFFTX",
        experiment="Count the bytes that fit until the FIFO is full.",
    )
    irs_clears_fifo: BoolOption = choice(
        False,
        True,
        question="Does IRS = 0 empty the FIFOs?",
        registers="I2CFFRX I2CFFTX",
        experiment="Fill the TX FIFO, write IRS = 0 and 1, and read TXFFST.",
    )
