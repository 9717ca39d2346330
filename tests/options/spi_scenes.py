"""Scenes whose records depend on options of the SPI. A bit of a master has 16 cycles, a level on a slave's pins 100."""

from __future__ import annotations

from periph_sim.core.options import Value
from tests.options.unit import Scene

MASTER = "PCLKCR0=100 +10 SPICCR=7 SPICTL=7 SPIBRR=3 SPICCR=87 "
LATE_CLOCK = "PCLKCR0=100 +10 SPICCR=7 SPICTL=f SPIBRR=3 SPICCR=87 "  # CLK_PHASE = 1
SLAVE = "PCLKCR0=100 +10 SPICCR=7 SPICTL=3 SPICCR=87 "
FIFO = "SPIFFTX=e000 SPIFFRX=2000 "


def spi(firmware: str, *, received: str = "", levels: dict[str, str] | None = None) -> Scene:
    """Return a scene. received: script of the service routine of SPIRXINTA. levels: of pins, by their signals."""
    service = {"SPIRXINTA": received} if received else {}
    return Scene(firmware, ("SPI-A",), service=service, levels=levels or {})


def clocked(*bits: int, ste: str = "", after: str = "") -> dict[str, str]:
    """Return the levels of a master that sends these bits, two levels each, latched at the fall of SPICLK."""
    clk = "0" + "10" * len(bits) + after
    simo = "0" + "".join(str(bit) * 2 for bit in bits)
    return {"SPICLKA": clk, "SPISIMOA": simo.ljust(len(clk), "0"), "SPISTEA": ste or "0" * len(clk) + "1"}


WORD = (1, 0, 1, 0, 0, 1, 0, 1)

SCENES = {
    "no clock": spi(MASTER + "PCLKCR0=0 +10 SPIBRR"),
    # transfers of a master
    "sent": spi(MASTER + "+37 SPITXBUF=5500 +1000 SPIRXBUF"),
    "FIFO with delay": spi(MASTER + FIFO + "SPIFFCT=4 SPITXBUF=1100 SPITXBUF=2200"),
    "halted": spi(MASTER + "SPITXBUF=5500 +60 HALT=1 +1000 HALT=0"),
    # flags and interrupts
    "received with CLK_PHASE = 1": spi(LATE_CLOCK + "SPITXBUF=5500 +1000", received="SPIRXBUF PIEACK=20"),
    "not read": spi(MASTER + "SPITXBUF=1100 +500 SPITXBUF=2200 +500", received="PIEACK=20"),
    "status in FIFO mode": spi(MASTER + FIFO + "SPITXBUF=1100 +500 SPISTS"),
    "FIFO flag cleared": spi(MASTER + FIFO + "SPIFFTX=e060 SPIFFTX"),
    "FIFO overflow": spi(
        MASTER + FIFO + "SPIFFRX=203f " + "SPITXBUF=1100 " * 10 + "+3000 " + "SPITXBUF=2200 " * 7 + "+3000",
        received="PIEACK=20",
    ),
    # buffers
    "written twice": spi(MASTER + "SPITXBUF=1100 SPITXBUF=2200 SPITXBUF=3300"),
    "FIFO written too often": spi(MASTER + FIFO + "SPICCR=7 " + "SPITXBUF=1100 " * 16 + "SPITXBUF=2200 SPICCR=87"),
    "FIFO read too often": spi(MASTER + FIFO + "SPITXBUF=5500 +500 SPIRXBUF SPIRXBUF"),
    # slave
    "answered": spi(SLAVE + "SPITXBUF=5500 +6000 SPIRXBUF", levels=clocked(*WORD)),
    "let go in a character": spi(
        SLAVE + "+9000 SPIRXBUF", levels=clocked(1, 1, 1, *WORD, ste="0" * 7 + "1" + "0" * 30)
    ),
    # resets
    "SW RESET with words": spi(MASTER + FIFO + "SPITXBUF=1100 SPITXBUF=2200 SPITXBUF=3300 SPICCR=7 SPIFFTX"),
    "SPIRST with words": spi(MASTER + FIFO + "SPITXBUF=1100 SPITXBUF=2200 SPITXBUF=3300 SPIFFTX=6000 SPIFFTX"),
}

ROWS: list[tuple[str, str, Value]] = [  # option, scene, an answer that gives other records
    ("start_point", "sent", "bit_clock"),
    ("ste_lead", "sent", "three_half_bits"),
    ("ste_in_txdly", "FIFO with delay", "high"),
    ("txdly_first_word", "FIFO with delay", "delay"),
    ("int_flag_point", "received with CLK_PHASE = 1", "latch_edge"),
    ("int_request", "not read", "every_character"),
    ("status_in_fifo_mode", "status in FIFO mode", "follows"),
    ("fifo_int_mode", "FIFO flag cleared", "edge"),
    ("rxffovf_interrupt", "FIFO overflow", "none"),
    ("txbuf_write_when_full", "written twice", "ignored"),
    ("txfifo_write_when_full", "FIFO written too often", "overwrites_last"),
    ("rxfifo_read_when_empty", "FIFO read too often", "zero"),
    ("input_latency", "answered", 3),
    ("ste_high_mid_character", "let go in a character", "restarts"),
    ("swreset_clears_fifos", "SW RESET with words", True),
    ("spirst_clears_fifos", "SPIRST with words", False),
    ("bits_after_suspend", "halted", "remainder"),
    ("clock_gate_access", "no clock", "accessible"),
]
