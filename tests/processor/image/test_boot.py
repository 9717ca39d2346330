"""Start addresses of images, and the values that stubs give to registers without a model."""

from __future__ import annotations

import pytest

from periph_sim.f28335.memory.memory_map import AddressMap
from periph_sim.processor.image.boot import BadStub, Stub, stubbed
from periph_sim.processor.image_files.model import BadImage
from tests.processor.image.rig import HEAD, Rig

FLASH = '.sect "codestart", 0x33FFF6\n LB #_main\n' + HEAD.replace("_c_int00", "_main") + " .entry _main\n"
ADCST = 0x7119


def test_flash_begins_at_the_address_of_the_boot_rom_with_half_the_crystal_frequency():
    rig = Rig(FLASH + " MOVW DP,#0x7011 >> 6\n MOV AL,@0x7011\n ESTOP0", boot="flash").run()
    assert rig.program.finished
    assert rig.cpu.acc & 0x180 == 2 << 7  # DIVSEL of PLLSTS
    assert rig.dsp.clock.hz == 15_000_000
    # LB, HEAD, MOVW, MOV; LB is fetched with 15 wait states
    assert rig.program.returned_at == 15 + 4 + 10 + 1 + 3


def test_the_entry_begins_with_the_clock_of_the_reset():
    rig = Rig(FLASH + " ESTOP0").run()
    assert (rig.dsp.clock.hz, rig.program.returned_at) == (7_500_000, 10)


def test_ram_begins_at_0():
    rig = Rig('.sect "codestart", 0\n MOVB ACC,#7\n ESTOP0\n' + HEAD + " ESTOP0", boot="ram").run()
    assert (rig.program.finished, rig.cpu.acc) == (True, 7)


def test_a_reset_boots_again():
    source = FLASH.replace("#0x68", "#0x28") + "loop: SB loop,UNC"
    rig = Rig(source, boot="flash").run(60_000_000)
    assert rig.dsp.resets >= 1
    assert rig.dsp.clock.hz == 15_000_000


def test_an_image_without_code_at_the_boot_address_is_refused():
    with pytest.raises(BadImage, match=r'boot = "flash" begins at 0x33fff6, where this image has nothing'):
        Rig(HEAD + " ESTOP0", boot="flash")


def test_a_stub_gives_its_value_from_its_time_on_regardless_of_writes():
    """The program waits for bit 0 of ADCST, which the stub sets after 100 us."""
    wait = (
        HEAD + f" MOVW DP,#{ADCST} >> 6\nloop: MOV @{ADCST},#2\n MOV AL,@{ADCST}\n TBIT @AL,#0\n SB loop,NTC\n ESTOP0"
    )
    ready = 300_000
    rig = Rig(wait, stubs=(Stub(0, ADCST, 0x10), Stub(ready, ADCST, 0x11))).run()
    ended = rig.program.returned_at
    assert ended is not None and rig.cpu.acc == 0x11
    assert ready < rig.dsp.clock.tick(ended) < ready + 40 * 400


@pytest.mark.parametrize(
    ("register", "address"),
    [("ADC.ADCST", 0x7119), ("ADC + 0x19", 0x7119), ("0x7119", 0x7119), (0x7119, 0x7119), ("SCI-B.SCIRXST", 0x7755)],
)
def test_a_stub_names_its_register(register: str | int, address: int):
    assert stubbed(register, AddressMap()) == address


@pytest.mark.parametrize(
    ("register", "sentence"),
    [
        ("ADC.ADCSTX", "there is no register"),
        ("ADC + 0x20", "there is no register"),
        ("0x9000", "0x009000 is not a register"),
        ("SYS.PLLSTS", "SYS.PLLSTS is modelled; stubs are for registers that are not"),
    ],
)
def test_a_stub_of_a_modelled_register_or_of_no_register_is_refused(register: str, sentence: str):
    memory = Rig(HEAD + " ESTOP0").dsp.memory
    with pytest.raises(BadStub, match=sentence):
        stubbed(register, memory)
