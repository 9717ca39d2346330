"""Parts of the family: the data of each part, and errors for addresses that a part does not have."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.f28335.descriptor import DescriptorError, Part
from periph_sim.f28335.parts import f28334, f28335, part_named, part_names
from periph_sim.processor.image_files.model import BadImage
from periph_sim.processor.user_code import FirmwareLost
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from periph_sim.scene.scene import Scene
from tests.processor.image.rig import HEAD, Rig

READS = " MOVL XAR4,#{address:#x}\n MOV AL,*XAR4\n ESTOP0"
AT = '.sect "codestart", {address:#x}\n_c_int00: ESTOP0\n .entry _c_int00\n'
CASE = """
name = "small"
duration = "1 ms"

[unit.dsp]
image = "{image}"
part = "{part}"
modules = []
"""


def test_each_file_is_a_part_and_has_its_name():
    assert part_names() == ("F28334", "F28335")
    assert [part_named(name) for name in part_names()] == [f28334.PART, f28335.PART]
    assert [part_named(name).name for name in part_names()] == ["F28334", "F28335"]
    assert part_named("f28335") is None and part_named("F28332") is None and part_named("../F28335") is None


@pytest.mark.parametrize(
    ("part", "sectors", "part_id"), [(f28335.PART, 8 * 0x8000, 0x00EF), (f28334.PART, 8 * 0x4000, 0x00EE)]
)
def test_data_of_a_part_are_those_of_the_manual(part: Part, sectors: int, part_id: int):
    """Each part has eight sectors of flash; the last one ends with the passwords (SPRS439M Figures 3-2 and 3-3)."""
    assert (len(part.flash), part.flash.stop, part.part_id) == (sectors, 0x34_0000, part_id)
    assert part.modules == f28335.PART.modules


@pytest.mark.parametrize(
    "flash", [range(0x2F_8000, 0x34_0000), range(0x32_0000, 0x33_FFFF), range(0x34_0000, 0x34_0000)]
)
def test_flash_that_no_part_of_the_family_has_is_refused(flash: range):
    with pytest.raises(DescriptorError, match=r"odd: its flash is at .*; expected the end of 0x300000 to 0x33ffff"):
        Part("odd", f28335.MODULES, flash, 0)


def test_an_image_reads_the_id_and_the_flash_of_its_part():
    for part, part_id in ((f28335.PART, 0x00EF), (f28334.PART, 0x00EE)):
        assert Rig(HEAD + READS.format(address=0x38_0090), part=part).run().cpu.acc & 0xFFFF == part_id
        assert Rig(HEAD + READS.format(address=0x32_0000), part=part).run().cpu.acc & 0xFFFF == 0xFFFF
        assert Rig(HEAD + READS.format(address=0x0882), part=part).run().cpu.acc & 0xFFFF == 0x00EF


def test_access_to_flash_that_the_part_does_not_have_is_an_error():
    source = HEAD + READS.format(address=0x31_FFFF)
    assert Rig(source).run().cpu.acc & 0xFFFF == 0xFFFF
    with pytest.raises(FirmwareLost, match="0x31ffff is read, where the F28334 has nothing"):
        Rig(source, part=f28334.PART).run()
    jumps = HEAD + " LB #0x310000"
    with pytest.raises(FirmwareLost, match="0x310000 is read, where the F28334 has nothing"):
        Rig(jumps, part=f28334.PART).run()


def test_an_image_that_does_not_fit_is_refused():
    assert Rig(AT.format(address=0x32_0000), part=f28334.PART).run().program.finished
    assert Rig(AT.format(address=0x31_FFFF)).run().program.finished
    sentence = r"section 'codestart' lies at 0x31ffff, where the F28334 has nothing; its flash begins at 0x320000"
    with pytest.raises(BadImage, match=sentence):
        Rig(AT.format(address=0x31_FFFF), part=f28334.PART)


def case(folder: Path, part: str, address: int) -> Path:
    (folder / "small.asm").write_text(AT.format(address=address))
    path = folder / "small.toml"
    path.write_text(CASE.format(image=folder / "small.asm", part=part))
    return path


def test_a_unit_of_a_case_names_its_part(tmp_path: Path):
    Scene(load(case(tmp_path, "F28335", 0x31_0000)))
    Scene(load(case(tmp_path, "F28334", 0x33_0000)))
    with pytest.raises(
        BadCase, match=r"small.toml.*: section 'codestart' lies at 0x310000, where the F28334 has nothing"
    ):
        Scene(load(case(tmp_path, "F28334", 0x31_0000)))
    with pytest.raises(BadCase, match=r"small.toml.*: there is no part 'F28333'; did you mean"):
        Scene(load(case(tmp_path, "F28333", 0x33_0000)))
