"""The descriptors of SCI-A, SCI-B and SCI-C.

Sources: SPRS439M Tables 3-10, 3-11; SPRUFZ5A section 1.2.10.1 and figure 1-10 (interrupts).
"""

from __future__ import annotations

from ..descriptor import Frame, Interrupt, ModuleDescriptor
from .register_map import BASES, SCI_MAP

RECEIVER = (
    *(f"SCIFFRX.{name}" for name in ("RXFFINT", "RXFFOVF", "RXFFIENA")),
    *(f"SCIRXST.{name}" for name in ("RXRDY", "BRKDT", "RXERROR")),
    "SCICTL1.RXERRINTENA",
    "SCICTL2.RXBKINTENA",
)
TRANSMITTER = ("SCIFFTX.TXFFINT", "SCIFFTX.TXFFIENA", "SCICTL2.TXRDY", "SCICTL2.TXINTENA")
PINS = {"A": (28, 29), "B": (19, 18), "C": (62, 63)}  # GPIO numbers of RX and TX


def sci(letter: str) -> ModuleDescriptor:
    name, rx, tx = f"SCI-{letter}", f"SCIRXD{letter}", f"SCITXD{letter}"
    return ModuleDescriptor(
        name=name,
        registers=SCI_MAP,
        base=BASES[name],
        size=0x10,
        frame=Frame.PF2,
        header={f"Sci{letter.lower()}Regs": 0},
        chip="sci.module.Sci",
        takes=("name", "options"),
        options="sci",
        options_class="sci.options.SciOptions",
        gate=f"SCI{letter}ENCLK",
        clock="LSPCLK",
        interrupts=(Interrupt(f"SCIRXINT{letter}", RECEIVER), Interrupt(f"SCITXINT{letter}", TRANSMITTER)),
        inputs=(rx,),
        outputs=(tx,),
        pins=dict(zip((rx, tx), PINS[letter], strict=True)),
        wires={"RX": rx, "TX": tx},
        plain=letter == "A",
    )


SCIS = tuple(map(sci, PINS))
