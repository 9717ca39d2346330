"""The three SCIs of a device: addresses, clock gates, LSPCLK and interrupt lines."""

from __future__ import annotations

import pytest

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.time import Timebase
from periph_sim.f28335.pie import register_map as pie_map
from periph_sim.f28335.sci.register_map import SCI_MAP
from periph_sim.f28335.system_control import register_map as clocks_map
from periph_sim.processor.dsp import Dsp, DspPlan

BASES = {"SCI-A": 0x7050, "SCI-B": 0x7750, "SCI-C": 0x7770}
GATES = {"SCI-A": 10, "SCI-B": 11, "SCI-C": 5}  # bits of PCLKCR0
LINES = {"SCI-A": (9, 1), "SCI-B": (9, 3), "SCI-C": (8, 5)}  # of RXINT; TXINT is the next line of the group
MAPS = {"SYS": clocks_map.MAP, "PIE": pie_map.MAP}
OFFSETS = {r.name: r.offset for r in SCI_MAP}


class Board:
    """A device with three SCIs in a kernel; accesses are a thousand cycles apart."""

    def __init__(self) -> None:
        timebase = Timebase(150_000_000)
        self.kernel = Kernel()
        self.dsp = Dsp(self.kernel, timebase, Recorder(), DspPlan("dsp", tuple(BASES), {}))

    def wait(self, cycles: int = 1000) -> int:
        """Run for a number of cycles and return the present cycle."""
        clock = self.dsp.clock
        self.kernel.run_until(clock.tick(clock.cycle_at(self.kernel.now) + cycles))
        return clock.cycle_at(self.kernel.now)

    def write(self, module: str, register: str, value: int) -> None:
        offset = MAPS.get(module, SCI_MAP)[register].offset
        self.dsp.sockets[module].write(self.wait(), offset, value)

    def read(self, module: str, register: str) -> int:
        return self.dsp.sockets[module].read(self.wait(), MAPS.get(module, SCI_MAP)[register].offset)

    def request(self, module: str, lines: int) -> None:
        """Request interrupts of a module: 1 RXINT, 2 TXINT, 3 both in one cycle."""
        socket = self.dsp.sockets[module]
        socket.chip.requests |= lines
        socket.publish(self.wait())

    def start_bit_length(self, module: str) -> int:
        """Return the length of the start bit of a sent 0xFF in cycles."""
        chip = self.dsp.sockets[module].chip
        self.write(module, "SCITXBUF", 0xFF)
        while chip.out:
            began = self.wait(1)
        while not chip.out:
            ended = self.wait(1)
        return ended - began


@pytest.mark.rule("SCI-001")
@pytest.mark.parametrize("module", BASES)
def test_each_module_answers_at_its_sixteen_addresses(module):
    memory = Board().dsp.memory
    for offset in range(16):
        address = BASES[module] + offset
        name = next((name for name, at in OFFSETS.items() if at == offset), None)
        if name is None:
            assert memory.at(address) is None and module in str(memory.refusal(address))
        else:
            assert memory.at(address) == (memory.places[module], SCI_MAP[name], 0)
    assert [memory.at(outside) for outside in (BASES[module] - 1, BASES[module] + 16)] == [None, None]


@pytest.mark.rule("SCI-001")
def test_the_modules_do_not_share_registers():
    board = Board()
    board.write("SYS", "PCLKCR0", sum(1 << bit for bit in GATES.values()))
    for i, module in enumerate(BASES):
        board.write(module, "SCILBAUD", 0x10 + i)
    assert [board.read(module, "SCILBAUD") for module in BASES] == [0x10, 0x11, 0x12]


@pytest.mark.rule("SCI-009")
@pytest.mark.parametrize("module", BASES)
def test_each_module_has_its_own_bit_in_pclkcr0(module):
    board = Board()
    board.write("SYS", "PCLKCR0", 1 << GATES[module])
    for name in BASES:
        board.write(name, "SCILBAUD", 0x55)
    assert {name: board.read(name, "SCILBAUD") for name in BASES} == dict.fromkeys(BASES, 0) | {module: 0x55}


@pytest.mark.rule("SCI-083")
@pytest.mark.parametrize(("lospcp", "divider"), [(0, 1), (1, 2), (2, 4), (3, 6), (7, 14)])
def test_lospcp_sets_the_rate(lospcp, divider):
    board = Board()
    board.write("SYS", "PCLKCR0", 1 << 10)
    board.write("SYS", "LOSPCP", lospcp)
    board.write("SCI-A", "SCILBAUD", 9)
    board.write("SCI-A", "SCICTL1", 0x22)
    assert board.start_bit_length("SCI-A") == 80 * divider


@pytest.mark.rule("SCI-146")
@pytest.mark.parametrize("module", BASES)
def test_each_request_has_its_own_pie_line_and_rx_comes_first(module):
    board = Board()
    group, line = LINES[module]
    pie = board.dsp.pie
    board.write("PIE", "PIECTRL", 1)
    board.write("PIE", f"PIEIER{group}", 0xFF)
    for lines, flags in ((1, 1 << line - 1), (2, 1 << line)):
        board.request(module, lines)
        assert board.read("PIE", f"PIEIFR{group}") == flags
        assert pie.vector(board.wait(), group)[0] == line + lines - 1
    board.request(module, 3)
    assert [pie.vector(board.wait(), group)[0] for _ in range(2)] == [line, line + 1]
