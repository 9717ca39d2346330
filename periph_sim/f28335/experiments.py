"""Experiments that would answer open questions about the hardware, at most one for each question.

The keys of EXPERIMENTS are the group and the name of the question's option. `run --questions` prints the experiments.
They have a file of their own, because the simulation does not need them. If a question has no entry here, like those
of the SPI, no experiment is printed for it.
"""

from __future__ import annotations

from collections.abc import Mapping

EXPERIMENTS: Mapping[str, Mapping[str, str]] = {
    "i2c": {
        "emdr_present": "Write 0, then 1, to 0x790B, and read both back.",
        "bcm_reset": "Read 0x790B after a reset.",
        "aas_sdir_point": "Step SCL by hand through the address byte, and read I2CSTR after each edge.",
        "dxr_to_xsr_copy_point": (
            "Write I2CDXR on an idle bus and read XRDY: 1 means eager. Then write I2CDXR between the ninth "
            "rise and fall of SCL, and see which byte is sent."
        ),
        "xrdy_rise_point": ("Write I2CDXR between the ninth rise and fall of SCL, and read I2CSTR until XRDY rises."),
        "xrdyint_when_idle": "Set I2CIER.XRDY on an idle bus, and see whether I2CISRC becomes 5.",
        "tx_underflow_policy": "Leave a byte of a read unserviced, and watch SCL and SDA.",
        "stretch_after_address_ack": "Leave the first byte of a read unserviced, and watch SCL and SDA.",
        "xsmt_rule": "Read I2CSTR again and again while SCL is stretched.",
        "stale_byte_next_read": "Let the firmware send a counter, read one byte twice, and compare.",
        "dxr_write_while_full": "Write 0x11, then 0x22, to I2CDXR on an idle bus, and read two bytes.",
        "dxr_survives_irs": ("Write I2CDXR, write IRS = 0 and 1, and read a byte that the firmware does not service."),
        "nack_clears_dxr": "Let the firmware send a counter, read one byte twice, and compare.",
        "xsmt_on_final_nack": "Read I2CSTR after a final NACK with I2CDXR empty.",
        "nackint_in_slave_tx": "Enable only the NACK interrupt, and end a read with NACK.",
        "sda_setup_before_scl_release": ("Measure the time from SDA to the rise of SCL at the end of a stretch."),
        "sdir_clear": "Read I2CSTR after the STOP of a read.",
        "cnt_in_slave_tx": "Set I2CCNT = 1 as slave, and read three bytes.",
        "irs_write1_releases_bus": "Let the slave stretch, write IRS = 1 without a 0 before, and watch SCL.",
        "rrdy_point": "Step SCL by hand through a received byte, and read I2CSTR after each edge.",
        "rx_overrun_policy": "Send bytes that the firmware does not read, and watch SCL and the ACK bit.",
        "rsfull_stretch_point": (
            "Send bytes that the firmware does not read, and see on which side of the ACK bit SCL stays low."
        ),
        "rrdy_clear_reads_drr": (
            "Clear RRDY by writing 1 after each byte without reading I2CDRR, send more bytes, and watch SCL."
        ),
        "mr_nack_at_count0": "Read as master with STP = 0, and watch the last ACK bit.",
        "rm_receiver": "Read as master in repeat mode, and count the bytes.",
        "bc_less_than_8_upper_bits": "Receive fewer than eight bits, and read I2CDRR.",
        "nackmod_on_address": "Set NACKMOD before an address byte, and watch its ACK bit.",
        "bb_on_irs_reset": "Write IRS = 0 and 1 after a START, and read BB.",
        "oar_latch": "Change I2COAR within an address byte, and see which address is answered.",
        "general_call": "Send address 0, and watch its ACK bit.",
        "scd_foreign": "Read SCD after a transfer to another address.",
        "start_byte_ad0": "Send 0x01, and read AD0.",
        "oar_zero": "Send 0x01 and 0x00 with I2COAR = 0, and watch the ACK bits.",
        "own_general_call": "Send a general call as the only module on the bus, and watch its ACK bit.",
        "aas_fdf_point": (
            "Step SCL by hand through the first byte in free data format, and read I2CSTR after each edge."
        ),
        "isrc_read_clears_aas": "Read I2CISRC = 7 within a transfer, and then I2CSTR.",
        "xrdy_w1c": "Write 0x0010 to I2CSTR with XRDY = 1, and read it back.",
        "int_line": "Use a service routine that does not read I2CISRC, and count its entries.",
        "event_to_isrc_delay": (
            "Toggle a pin in the service routine, and measure from the edge of SCL, less the interrupt latency."
        ),
        "int_priority": "Let two flags wait, and read I2CISRC twice.",
        "isrc_preempt": "Leave the code of RRDY unread, provoke a NACK, and read I2CISRC.",
        "isrc_follows_flag": "Read I2CDRR before I2CISRC.",
        "irs_clears_commands": "Set STT, STP and NACKMOD, write IRS = 0, and read I2CMDR.",
        "irs_clears_isrc": "Write IRS = 0 and 1 with a code waiting, and read I2CISRC.",
        "ardy_on_nack": "Address an absent slave as master, and read ARDY.",
        "hold_scl_after_nack": "Address an absent slave as master, and watch SCL.",
        "cnt_copy_point": "Change I2CCNT within a transfer as master, and count the bytes.",
        "stt_while_busy": "Set STT during a transfer of another master.",
        "foreign_start_stop": "Force a START within a byte sent as master, and read AL.",
        "al_clears_stt": "Force a lost arbitration before the START, and read I2CMDR.",
        "stop_without_data": "Set STP after an address that was answered NACK, and watch for the STOP.",
        "ten_bit_read": "Set STT with XA = 1 and TRX = 0 on an idle bus, and decode the address bytes.",
        "stt_with_irs_write": "Write I2CMDR = 0x2620 after a reset, and watch for the START.",
        "scl_sync_cycles": "Compare the period of SCL with I2CCLKL and I2CCLKH while edges are slow.",
        "dlb_delay": "Measure from the I2CDXR write to RRDY in loopback.",
        "noise_filter_cycles": ("Send pulses of growing width with a generator, or measure from an edge to its flag."),
        "unequal_arrival": "Change SCL and SDA a fraction of a module clock apart, and read BB.",
        "psc_write_irs1": "Write I2CPSC with IRS = 1, read it back, write IRS = 0 and 1, and measure SCL.",
        "clock_gate_access": "Read a register with I2CAENCLK = 0.",
        "free_slave_unit": "Stop at a breakpoint within a transfer, and see when the slave stops.",
        "fifo_int_mode": "Clear TXFFINT while TXFFST = 0, and read it back.",
        "fifo_17th_byte": "Send 18 bytes that the firmware does not read, and watch SCL and the ACK bit.",
        "txfifo_reset_flushes_xsr": "Reset the TX FIFO after a read, and read again.",
        "fifo_extra_stage": "Count the bytes that fit until the FIFO is full.",
        "irs_clears_fifo": "Fill the TX FIFO, write IRS = 0 and 1, and read TXFFST.",
    },
    "sci": {
        "rxrdy_point": "Toggle a pin when a poll sees RXRDY, and measure from the stop bit on the line.",
        "rx_int_extra": (
            "Toggle a pin in the service routine, and measure from the stop bit, less the interrupt latency."
        ),
        "stop_vote_samples": "Send a stop bit shortened to 5/8 of a bit, and read FE.",
        "start_hunt_point": "Send frames with shortened stop bits, and see which are received.",
        "addrbit_hunt_with_parity": "Send address-bit frames with parity from a slow sender.",
        "break_bits": "Send low pulses of growing length, and read BRKDT.",
        "break_count_from": "Send low pulses of growing length, and read BRKDT.",
        "rx_after_break": "Send a byte after a break, and read RXRDY.",
        "rx_sync_stages": "Collect statistics of the time from a start bit to RXRDY.",
        "break_char_delivered": "Read RXFFST after a break.",
        "brkdt_in_sleep": "Send a break with SLEEP = 1, and read BRKDT.",
        "error_flags_sticky": "Send one bad and one good character, and read SCIRXST.",
        "sleep_loads_buffer": "Send data frames with SLEEP = 1, and read SCIRXBUF and RXFFST.",
        "rxwake_idle_point": "Poll SCIRXST on an idle line.",
        "rxrdy_in_fifo_mode": "Poll RXRDY and RXFFST in FIFO mode while a word arrives.",
        "oe_in_fifo_mode": "Send two words in FIFO mode without reading them, and read OE; then 17.",
        "fifo_overflow_drops": "Send 1 to 18 without reading, then read the FIFO.",
        "rxffovf_interrupt": "Send 17 words with RXFFIL = 31, and count the interrupts.",
        "rxerr_int_mode": "Send two bad characters, and count the interrupts.",
        "rxfifo_read_when_empty": "Read SCIRXBUF with the FIFO empty.",
        "fifo_int_mode": "Clear a FIFO interrupt flag while its condition holds, and read it back.",
        "txfifo_write_when_full": "Write 18 words to the FIFO, and decode the line.",
        "txrdy_point": "Toggle a pin when a poll sees TXRDY, and measure from the start bit.",
        "tx_reload_point": "Toggle a pin when a poll sees TXRDY, and measure from the stop bit.",
        "txempty_fall": "Read SCICTL2 again and again after a SCITXBUF write.",
        "txbuf_write_when_full": "Write SCITXBUF twice without waiting, and decode the line.",
        "tx_phase": "Collect statistics of the time from a SCITXBUF write to its start bit.",
        "txena_clear_drains": "Clear TXENA while words wait, and decode the line.",
        "txwake_idle_len": "Measure the idle time that TXWAKE sends.",
        "parity_of_short_chars": "Send short characters with upper bits set, and decode the parity.",
        "fftxdly_first_word": "Measure from the write of the first word to its start bit with FFTXDLY set.",
        "fftxdly_max": "Measure the gap between words with FFTXDLY = 255.",
        "fftxdly_unit": "Measure the gap between words with FFTXDLY set.",
        "swreset_fifo_effect": "Fill the transmit FIFO, write SW RESET = 0 and 1, and read TXFFST.",
        "txbuf_write_in_swreset": "Write SCITXBUF with SW RESET = 0, release it, and decode the line.",
        "scirst_scope": "Read all registers after SCIRST = 0.",
        "autobaud_brr_rule": "Vary the host's rate in small steps, and read the divider.",
        "brr_write_effect": "Change the divider within a frame, and measure its bits.",
        "format_write_effect": "Change SCICCR within a frame, and decode the line.",
        "clock_gate_access": "Read a register with the module's clock off.",
        "idle_before_first_frame": ("Release SW RESET on an idle line, wait, and read RXWAKE with the first frame."),
        "txrdy_in_fifo_mode": "Poll TXRDY in FIFO mode while words wait.",
    },
    "system": {
        "int_latency": ("Toggle a pin in the service routine of a CPU timer, and measure from the timer's reload."),
        "vector_fetch_waits": (
            "Toggle a pin in the service routine of a CPU timer, and measure from the timer's reload."
        ),
        "irq_after_iret": (
            "Hold an interrupt request, and count the main program's instructions between service routines."
        ),
        "intr_clears_ifr": "Execute INTR with the IFR bit set, and read IFR.",
        "pieack_reset": "Read PIEACK first thing after a reset.",
        "pf2_read_ws": "Measure a row of reads with a CPU timer.",
        "pf2_write_ws": "Measure a row of writes with a CPU timer.",
        "pf1_back_to_back_write": ("Write GPASET and GPACLEAR without a NOP in between, and measure the pulse."),
        "gpio_out_delay": "Compare an output pin with a peripheral's output of the same cycle.",
        "timer_tif_point": "Read TIM and TCR again and again with TDDR = 3.",
        "timer_late_tie": "Set TIE while TIF is 1, and count the interrupts.",
        "pll_lock_clock": "Watch XCLKOUT while the PLL locks.",
        "lspclk_phase": "Measure from a LOSPCP write to the next edges of the SCI.",
        "wd_divider": "Measure the time from a clear of WDCNTR to the watchdog's reset.",
        "wd_bad_key": "Write 0x32 to WDKEY.",
    },
}
