"""Scenes whose records depend on options of the I2C module. A byte of a partner takes 3375 cycles with its ACK."""

from __future__ import annotations

from collections.abc import Callable

from periph_sim.core.options import Value
from tests.f28335.i2c_bus import SCL, SDA, Foreign, LineDriver, Party, Target
from tests.options.unit import START, Scene

ON = "PCLKCR0=10 +10 I2CPSC=e I2CCLKL=a I2CCLKH=5 I2COAR=50 I2CSAR=50 "


def i2c(
    firmware: str, *partners: Callable[[], Party], service: str = "", cycles: int = 60_000, **answers: Value
) -> Scene:
    """Return a scene. partners: functions that create bus partners. service: script of the routine of I2CINT1A."""
    return Scene(
        ON + firmware,
        ("I2C-A",),
        service={"I2CINT1A": service} if service else {},
        partners=lambda: [make() for make in partners],
        cycles=cycles,
        answers={"i2c": answers},
    )


def master(script: str) -> Callable[[], Party]:
    return lambda: Foreign(script, START)


def hand(*moves: tuple[int, int, int]) -> Callable[[], Party]:
    """Return a partner that pulls (0) and releases (1) wires: (cycles after START, line, level)."""

    def make() -> Party:
        party = LineDriver()
        for time, line, level in moves:
            party.put_later(START + time, line, level)
        return party

    return make


SCENES = {
    "registers": i2c(
        "I2CEMDR I2CEMDR=0 I2CEMDR I2CMDR=20 I2CPSC=4 I2CPSC I2CSTR=10 I2CSTR I2CMDR=8820 I2CMDR=8800 I2CMDR"
    ),
    "no clock": i2c("PCLKCR0=0 +10 I2COAR"),
    "data wanted": i2c("I2CIER=10 I2CMDR=20 +100 I2CISRC"),
    # slave-receiver
    "received": i2c("I2CMDR=20 ~AAS I2CSTR ~RRDY I2CDRR +8000 I2CDRR I2CDRR", master("S 50W 11 22 33 P")),
    "received, RRDY cleared": i2c("I2CMDR=20 ~RRDY I2CSTR=8 +4000 I2CDRR", master("S 50W 11 22 P")),
    "received, NACKMOD": i2c("I2CMDR=8020 +12000 I2CSTR", master("S 50W 11 P")),
    "received, four bits": i2c("I2CMDR=24 ~RRDY I2CDRR ~RRDY I2CDRR", master("S 50W f0 P")),
    "received without address": i2c("I2CMDR=28 ~AAS I2CSTR", master("S 11 P")),
    "halted": i2c("I2CMDR=20 ~AAS +2000 HALT=1 +20000 HALT=0 I2CDRR", master("S 50W 11 22 P")),
    # slave-transmitter
    "sent late": i2c("I2CMDR=20 ~AAS +9000 I2CDXR=11 +9000 I2CDXR=22 +6000 I2CSTR", master("S 50R ?A ?N P")),
    "sent, copied at rise 9": i2c(
        "I2CMDR=20 ~AAS I2CDXR=11 ~XRDY I2CSTR", master("S 50R ?N P"), dxr_to_xsr_copy_point="ack_rise9"
    ),
    "sent, BCM = 0": i2c("I2CEMDR=0 I2CMDR=20 ~AAS +6000 I2CSTR I2CDXR=11 I2CSTR", master("S 50R ?N P")),
    "written twice": i2c("I2CMDR=20 I2CDXR=11 I2CDXR=22", master("S 50R ?N P")),
    "written before IRS = 0": i2c("I2CMDR=20 I2CDXR=11 I2CMDR=0 I2CMDR=20 ~AAS +6000 I2CDXR=33", master("S 50R ?N P")),
    "a byte too many": i2c(
        "I2CMDR=20 ~AAS I2CDXR=11 ~XRDY I2CDXR=22 +14000 I2CDXR=33", master("S 50R ?N P +2000 S 50R ?N P")
    ),
    "refused": i2c("I2CIER=2 I2CMDR=20 ~AAS I2CDXR=11 +12000 I2CISRC I2CSTR", master("S 50R ?N P")),
    "counted": i2c("I2CCNT=2 I2CMDR=20 ~AAS I2CDXR=11 ~XRDY I2CDXR=22 ~XRDY I2CDXR=33", master("S 50R ?A ?A ?N P")),
    "IRS = 1 in a stretch": i2c("I2CMDR=20 ~AAS +6000 I2CMDR=20", master("S 50R ?N P")),
    # bus state, addresses
    "IRS = 0 in a transfer": i2c("I2CMDR=20 ~AAS I2CMDR=0 I2CSTR", master("S 50W 11 P")),
    "own address changed": i2c("I2CMDR=20 I2COAR=2a", master("S 2aW 11 P")),
    "general call": i2c("I2CMDR=20", master("S 00W 11 P")),
    "for others": i2c("I2CMDR=20 +20000 I2CSTR", master("S 2aW 11 P")),
    "START byte": i2c("I2CMDR=20 +7200 I2CSTR", master("S 01 P")),
    "START byte, I2COAR = 0": i2c("I2COAR=0 I2CMDR=20", master("S 01 P")),
    "both lines at once": i2c("I2CMDR=20 +6000 I2CSTR", hand((0, SDA, 0), (7, SCL, 0))),
    # interrupts
    "served": i2c("I2CIER=8 I2CMDR=20 +40000 I2CDRR", master("S 50W 11 P"), service="+100 PIEACK=80 +100 I2CISRC"),
    "AAS read": i2c("I2CIER=40 I2CMDR=20 ~AAS +10 I2CISRC I2CSTR", master("S 50W P")),
    "two codes": i2c("I2CMDR=20 ~SCD I2CIER=28 +10 I2CISRC", master("S 50W 11 P")),
    "a higher code": i2c("I2CIER=a I2CMDR=20 ~RRDY ~SDIR I2CDXR=11 ~NACK +10 I2CISRC", master("S 50W 11 S 50R ?N P")),
    "flag cleared": i2c("I2CIER=8 I2CMDR=20 ~RRDY I2CDRR +10 I2CISRC", master("S 50W 11 P")),
    "IRS = 0 with a code": i2c("I2CIER=8 I2CMDR=20 ~RRDY +10 I2CMDR=0 +10 I2CISRC", master("S 50W 11 P")),
    # master
    "nobody answers": i2c("I2CCNT=1 I2CMDR=2620 ~NACK +1000 I2CSTR I2CMDR=0e20 +3000 I2CSTR"),
    "STT with IRS": i2c("I2CCNT=1 I2CDXR=12 I2CMDR=2e20", Target),
    "count changed": i2c("I2CCNT=2 I2CMDR=2620 ~XRDY I2CDXR=1 ~XRDY I2CDXR=2 I2CCNT=3 +9000 I2CSTR", Target),
    "two bytes read": i2c("I2CCNT=2 I2CMDR=2420 ~RRDY I2CDRR ~RRDY I2CDRR", lambda: Target(gives=[1, 2, 3])),
    "read in repeat mode": i2c(
        "I2CCNT=2 I2CMDR=24a0 ~RRDY I2CDRR ~RRDY I2CDRR ~RRDY I2CDRR", lambda: Target(gives=[1, 2, 3, 4])
    ),
    "10-bit read": i2c("I2CSAR=234 I2CCNT=1 I2CMDR=2d20 ~RRDY I2CDRR", lambda: Target(0x234, [0x99])),
    "own general call": i2c("I2CSAR=0 I2CCNT=1 I2CMDR=2620"),
    "stretched by the target": i2c("I2CCNT=1 I2CDXR=12 I2CMDR=2e20", lambda: Target(stretch={(0, 4): 900})),
    "loopback": i2c("I2COAR=2a I2CCNT=1 I2CMDR=6e60 +6000 I2CDXR=5c ~RRDY I2CDRR"),
    "bus taken": i2c("I2CMDR=20 ~BB +4000 I2CCNT=1 I2CDXR=12 I2CMDR=2e20 +200 I2CMDR", master("S 48W 77 P"), Target),
    "foreign START": i2c("I2CCNT=2 I2CDXR=ff I2CMDR=2e20 +9000 I2CMDR", Target, hand((1040, SDA, 0), (1500, SDA, 1))),
    # FIFOs
    "FIFO flags cleared": i2c(
        "I2CFFTX=6000 I2CFFRX=2001 I2CMDR=20 ~SCD I2CFFTX=6040 I2CFFTX I2CFFRX I2CDXR=11 I2CFFTX I2CMDR=0 I2CFFRX",
        master("S 50W 11 P"),
    ),
    "a 17th byte": i2c(
        "I2CFFTX=6000 I2CFFRX=2010 I2CMDR=20 +70000 I2CDRR",
        master("S 50W 0 1 2 3 4 5 6 7 8 9 a b c d e f 10 11 P"),
        cycles=90_000,
    ),
    "TX FIFO reset": i2c(
        "I2CFFTX=6000 I2CFFRX=2000 I2CMDR=20 ~AAS I2CDXR=11 +4000 I2CFFTX=4000 I2CFFTX=6000 +9000 I2CDXR=22",
        master("S 50W 0 S 50R ?N P"),
    ),
}

ROWS: list[tuple[str, str, Value]] = [  # option, scene, an answer that gives other records
    ("emdr_present", "registers", False),
    ("bcm_reset", "registers", 0),
    ("aas_sdir_point", "received", "fall9"),
    ("dxr_to_xsr_copy_point", "written twice", "eager"),
    ("dxr_to_xsr_copy_point", "STT with IRS", "eager"),
    ("xrdy_rise_point", "sent, copied at rise 9", "at_copy"),
    ("xrdyint_when_idle", "data wanted", "only_addressed"),
    ("tx_underflow_policy", "sent late", "send_ones"),
    ("stretch_after_address_ack", "sent late", False),
    ("xsmt_rule", "sent, BCM = 0", "figure"),
    ("stale_byte_next_read", "a byte too many", "discarded"),
    ("dxr_write_while_full", "written twice", "ignored"),
    ("dxr_survives_irs", "written before IRS = 0", "kept_and_still_sent"),
    ("nack_clears_dxr", "a byte too many", True),
    ("xsmt_on_final_nack", "refused", "0_without_stretch"),
    ("nackint_in_slave_tx", "refused", False),
    ("sda_setup_before_scl_release", "sent late", 7),
    ("sdir_clear", "refused", "until_next_address"),
    ("cnt_in_slave_tx", "counted", "counts_bytes"),
    ("irs_write1_releases_bus", "IRS = 1 in a stretch", True),
    ("rrdy_point", "received", "fall9"),
    ("rx_overrun_policy", "received", "nack"),
    ("rsfull_stretch_point", "received", "before_ack"),
    ("rrdy_clear_reads_drr", "received, RRDY cleared", False),
    ("mr_nack_at_count0", "two bytes read", "only_with_stp"),
    ("rm_receiver", "read in repeat mode", "ignored"),
    ("bc_less_than_8_upper_bits", "received, four bits", "zeros"),
    ("nackmod_on_address", "received, NACKMOD", "address_too"),
    ("bb_on_irs_reset", "IRS = 0 in a transfer", "clear"),
    ("oar_latch", "own address changed", "at_irs"),
    ("general_call", "general call", "ignored"),
    ("scd_foreign", "for others", "own_transfers"),
    ("start_byte_ad0", "START byte", "set"),
    ("oar_zero", "START byte, I2COAR = 0", "own_address_too"),
    ("own_general_call", "own general call", "answered"),
    ("aas_fdf_point", "received without address", "ack"),
    ("isrc_read_clears_aas", "AAS read", True),
    ("xrdy_w1c", "registers", "yes"),
    ("int_line", "served", "level"),
    ("event_to_isrc_delay", "served", 9),
    ("int_priority", "two codes", "descending"),
    ("isrc_preempt", "a higher code", "first_come"),
    ("isrc_follows_flag", "flag cleared", "vanishes"),
    ("irs_clears_commands", "registers", False),
    ("irs_clears_isrc", "IRS = 0 with a code", False),
    ("ardy_on_nack", "nobody answers", False),
    ("hold_scl_after_nack", "nobody answers", False),
    ("cnt_copy_point", "count changed", "write"),
    ("stt_while_busy", "bus taken", "foreign_waits"),
    ("foreign_start_stop", "foreign START", "loses_arbitration"),
    ("al_clears_stt", "bus taken", False),
    ("stop_without_data", "nobody answers", "waits_for_data"),
    ("ten_bit_read", "10-bit read", "full_address_first"),
    ("stt_with_irs_write", "STT with IRS", "dropped"),
    ("scl_sync_cycles", "stretched by the target", 3),
    ("dlb_delay", "loopback", "after_dxr_write"),
    ("noise_filter_cycles", "received", 4),
    ("unequal_arrival", "both lines at once", "one_sample"),
    ("psc_write_irs1", "registers", "dropped"),
    ("clock_gate_access", "no clock", "accessible"),
    ("free_slave_unit", "halted", "whole_transfer"),
    ("fifo_int_mode", "FIFO flags cleared", "edge"),
    ("fifo_17th_byte", "a 17th byte", "nack"),
    ("txfifo_reset_flushes_xsr", "TX FIFO reset", True),
    ("fifo_extra_stage", "FIFO flags cleared", "dxr_drr_behind"),
    ("irs_clears_fifo", "FIFO flags cleared", True),
]
