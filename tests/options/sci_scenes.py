"""Scenes whose records depend on options of the SCI. A bit has 800 cycles, a sample of RXD has 100."""

from __future__ import annotations

from periph_sim.core.options import Value
from tests.f28335.sci_rig import frame
from tests.options.unit import Scene

ON = "PCLKCR0=400 +10 SCICCR=7 SCICTL1=3 SCIHBAUD=0 SCILBAUD=18 SCICTL1=23 "
FIFO = "SCIFFTX=e000 SCIFFRX=2000 "


def sci(
    firmware: str, rxd: str = "", *, received: str = "", sent: str = "", cycles: int = 60_000, **answers: Value
) -> Scene:
    """Return a scene. rxd: samples. received, sent: scripts of the service routines of SCIRXINTA and SCITXINTA."""
    service = {vector: text for vector, text in (("SCIRXINTA", received), ("SCITXINTA", sent)) if text}
    levels = {"SCIRXDA": rxd} if rxd else {}
    return Scene(ON + firmware, ("SCI-A",), service=service, levels=levels, cycles=cycles, answers={"sci": answers})


def bits(levels: str) -> str:
    """Return samples of RXD for these levels, each of one bit."""
    return "".join(level * 8 for level in levels.replace(" ", ""))


def characters(*words: int, **form: int | str) -> str:
    """Return samples of frames, each followed by a bit of 1."""
    return "".join(bits(frame(word, **form) + "1") for word in words)  # type: ignore[arg-type]


LOOK = "+50 SCIRXST "
BREAK = bits("0" * 25 + "1" * 3)

SCENES = {
    # receiver, line side
    "received": sci("SCICTL2=2 +20000", characters(0x4B), received="SCIRXBUF PIEACK=100"),
    "ragged stop bit": sci("+20000 SCIRXST", bits("0 11010010") + "00110000" + "1" * 16),
    "start bit in the stop bit": sci(FIFO + "+40000 SCIFFRX", bits("0 11010010") + "11111" + "0" * 5 + "1" * 100),
    "start bit in the parity bit": sci("SCICCR=6f " + FIFO + "+45000 SCIFFRX", bits("0 11010010 0 0 1") + "1" * 8 * 16),
    "break": sci("SCICTL2=2 +25000", "0" * 157 + "1" * 16, received="SCIRXST PIEACK=100"),
    "long break": sci("SCICTL2=2 +25000", BREAK, received="SCIRXST PIEACK=100"),
    "word behind a break": sci(FIFO + "+50000 SCIFFRX", BREAK + characters(0x4B)),
    # receiver, flags and buffer
    "break asleep": sci("SCICCR=f SCICTL1=27 SCICTL2=2 +40000 SCIRXST", BREAK),
    "three errors": sci(
        "SCICTL1=63 +40000 SCIRXST",
        characters(0x11, 0x22, bad="stop") + characters(0x33),
        received="SCIRXBUF PIEACK=100",
    ),
    "data asleep": sci("SCICCR=f SCICTL1=27 +20000 SCIRXEMU", characters(0x22, address=0)),
    "idle line": sci("+14000 SCIRXBUF +11000 SCIRXST", characters(0x22)),
    "idle line at first": sci("SCICTL1=27 +30000 SCIRXST", bits("1" * 12) + characters(0x11)),
    "words in the FIFO": sci(FIFO + "+24000 SCIRXST SCIRXBUF SCIRXBUF SCIRXBUF", characters(0x11, 0x22)),
    "FIFO overflow": sci(
        FIFO + "SCIFFRX=203f +160000 SCIRXBUF", characters(*range(17)), received="PIEACK=100", cycles=180_000
    ),
    # FIFO interrupts
    "FIFO flag cleared": sci(FIFO + "SCIFFTX=e060 SCIFFTX"),
    # transmitter
    "FIFO written too often": sci("SCICTL1=21 " + FIFO + "SCITXBUF=1 " * 16 + "SCITXBUF=99 SCICTL1=23", cycles=150_000),
    "FIFO stopped": sci(FIFO + "SCITXBUF=1 SCITXBUF=2 SCITXBUF=3 +1600 SCICTL2 SCICTL1=21", cycles=50_000),
    "sent": sci("SCITXBUF=55 " + "SCICTL2 +20 " * 10 + "+1000 SCITXBUF=22 SCITXBUF=33 +6600 SCICTL2"),
    "idle time": sci("SCITXBUF=1f +1600 SCICTL1=2b SCITXBUF=0 +8000 SCITXBUF=1f"),
    "short word with parity": sci("SCICCR=62 SCITXBUF=83"),
    "FIFO with delay": sci(FIFO + "SCIFFCT=ff SCITXBUF=1 SCITXBUF=2", cycles=450_000),
    # resets
    "SW RESET with words": sci(FIFO + "SCITXBUF=1 SCITXBUF=2 SCITXBUF=3 SCICTL1=3 SCIFFTX"),
    "written in SW RESET": sci("SCICTL1=3 SCITXBUF=4b SCICTL1=23"),
    "SCIRST with words": sci(FIFO + "SCITXBUF=1 SCITXBUF=2 SCITXBUF=3 SCIFFTX=6000 SCIFFTX"),
    # rate and format
    "autobaud": sci("SCILBAUD=1 SCIFFCT=2000 +30000 SCILBAUD", "".join(level * 13 for level in frame(0x41) + "1")),
    "rate changed": sci("SCITXBUF=55 +350 SCILBAUD=31"),
    "format changed": sci("SCITXBUF=aa +1600 SCICCR=4"),
    "no clock": Scene("SCICTL2", ("SCI-A",)),
}

ROWS: list[tuple[str, str, Value]] = [  # option, scene, an answer that gives other records
    ("rxrdy_point", "received", "stop_end"),
    ("rx_int_extra", "received", 9),
    ("stop_vote_samples", "ragged stop bit", "3_4_5"),
    ("start_hunt_point", "start bit in the stop bit", 8),
    ("addrbit_hunt_with_parity", "start bit in the parity bit", "parity_bit"),
    ("break_bits", "break", "9.625"),
    ("break_count_from", "long break", "stop_end"),
    ("rx_after_break", "word behind a break", "next_high"),
    ("rx_sync_stages", "received", 0),
    ("break_char_delivered", "word behind a break", False),
    ("brkdt_in_sleep", "break asleep", "suppressed"),
    ("error_flags_sticky", "three errors", False),
    ("sleep_loads_buffer", "data asleep", True),
    ("rxwake_idle_point", "idle line", "next_character"),
    ("rxrdy_in_fifo_mode", "words in the FIFO", "follows"),
    ("oe_in_fifo_mode", "words in the FIFO", "per_unread_word"),
    ("fifo_overflow_drops", "FIFO overflow", "newest"),
    ("rxffovf_interrupt", "FIFO overflow", "rxffiena"),
    ("rxerr_int_mode", "three errors", "every_error"),
    ("rxfifo_read_when_empty", "words in the FIFO", "zero"),
    ("fifo_int_mode", "FIFO flag cleared", "edge"),
    ("txfifo_write_when_full", "FIFO written too often", "overwrites_last"),
    ("txrdy_point", "sent", "next_lspclk"),
    ("tx_reload_point", "sent", "stop_begin"),
    ("txempty_fall", "sent", "halfway"),
    ("txbuf_write_when_full", "sent", "ignored"),
    ("tx_phase", "sent", "next_bit_tick"),
    ("txena_clear_drains", "FIFO stopped", "current_only"),
    ("txwake_idle_len", "idle time", "one_frame"),
    ("parity_of_short_chars", "short word with parity", "whole_byte"),
    ("fftxdly_first_word", "FIFO with delay", "delay"),
    ("fftxdly_max", "FIFO with delay", 256),
    ("fftxdly_unit", "FIFO with delay", "sciclk"),
    ("swreset_fifo_effect", "SW RESET with words", "cleared"),
    ("txbuf_write_in_swreset", "written in SW RESET", "sent_after_release"),
    ("scirst_scope", "SCIRST with words", "shifters"),
    ("autobaud_brr_rule", "autobaud", "truncated"),
    ("brr_write_effect", "rate changed", "at_once"),
    ("format_write_effect", "format changed", "at_once"),
    ("clock_gate_access", "no clock", "accessible"),
    ("idle_before_first_frame", "idle line at first", False),
    ("txrdy_in_fifo_mode", "FIFO stopped", "follows_fifo"),
]
