"""Each C statement on a register makes the accesses of the chip for every declared type, or the type is refused."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.processor.host_code import firmware
from periph_sim.processor.host_code.register_layout import BadLayout, RegisterLayout
from periph_sim.processor.image.elsewhere import UnmappedMemory
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from periph_sim.scene.scene import Scene

from .register_matrix import FIRST, Access, matrix

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc, which compiles C sources, is not installed")

CASE = """\
name = "registers"
duration = "100 ms"

[unit.dsp]
sources = ["main.c"]
modules = ["GPIO"]
compile = {{ undefined = {undefined} }}

[[budget]]
name = "resets"
measure = "lost flags"
max = 0
"""


class Recorded(UnmappedMemory):
    """The memory of modules that are not modelled, with a log of accesses."""

    log: list[tuple[str, int, int, int]]

    def read(self, cycle: int, address: int) -> int:
        value = super().read(cycle, address)
        self.log.append(("R", cycle, address, value))
        return value

    def write(self, cycle: int, address: int, value: int) -> bool:
        self.log.append(("W", cycle, address, value))
        return super().write(cycle, address, value)


def accesses(log: list[tuple[str, int, int, int]]) -> list[Access]:
    """Return accesses; words of one cycle are joined to one access."""
    found: list[Access] = []
    last = (-1, "")
    for how, cycle, address, value in log:
        if last == (cycle, how) and found[-1][1] + found[-1][2] == address:
            _, first, count, low = found[-1]
            found[-1] = how, first, count + 1, low | value << 16 * count
        else:
            found.append((how, address, 1, value))
        last = cycle, how
    return found


def run(folder: Path, monkeypatch: pytest.MonkeyPatch, text: str, undefined: str = "false") -> list[Access]:
    """Return the accesses that a main makes to registers without a model."""
    (folder / "main.c").write_text(text)
    (folder / "case.toml").write_text(CASE.format(undefined=undefined))
    monkeypatch.setattr(firmware, "UnmappedMemory", Recorded)
    monkeypatch.setattr(Recorded, "log", [], raising=False)
    result = Scene(load(folder / "case.toml")).run()
    assert not result.stuck, result.stuck
    return accesses(Recorded.log)


def check(seen: list[Access], statements: list[tuple[str, list[Access]]]) -> None:
    left = iter(seen)
    for statement, expected in statements:
        assert [next(left, None) for _ in expected] == expected, statement
    assert next(left, None) is None


@pytest.mark.parametrize(("undefined", "shapes", "every"), [("false", 3, 9), ("true", 10, 13)])
def test_each_statement_makes_the_accesses_of_the_chip(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, undefined: str, shapes: int, every: int
):
    text, statements = matrix(shapes, every)
    check(run(tmp_path, monkeypatch, text, undefined), statements)


MIXED = """\
#include <stdint.h>
enum state { OFF, ON };
struct MIXED {
    uint16_t a; uint32_t b; enum state c; unsigned char d; unsigned short e[3]; unsigned long f;
    struct { uint16_t g; struct { uint32_t h; uint16_t i; } inner[2]; } nested;
    union { uint32_t all; struct { uint16_t low; uint16_t high; } half; } j;
    struct { uint16_t k : 4; uint16_t : 4; uint16_t l : 8; uint16_t m : 12; uint16_t n : 8; uint16_t rest : 8;
             uint16_t after; } fields;
    int o; uint16_t *p; _Bool q; float r; const volatile long s;
};
extern volatile struct MIXED ECanaRegs;
struct SYS_CTRL_REGS { unsigned int reserved[25], WDCR; };
extern volatile struct SYS_CTRL_REGS SysCtrlRegs;
int main(void) {
    asm(" EALLOW"); SysCtrlRegs.WDCR = 0x68;
    ECanaRegs.a = 1; ECanaRegs.b = 0x20002; ECanaRegs.c = ON; ECanaRegs.d = 4; ECanaRegs.e[2] = 5;
    ECanaRegs.f = 0x60006;
    ECanaRegs.nested.g = 7; ECanaRegs.nested.inner[1].h = 0x80008; ECanaRegs.nested.inner[1].i = 9;
    ECanaRegs.j.all = 0xA000A; ECanaRegs.j.half.high = 11;
    ECanaRegs.fields.l = 12; ECanaRegs.fields.m = 13; ECanaRegs.fields.n = 14;
    ECanaRegs.fields.after = 15;
    ECanaRegs.o = -1; ECanaRegs.p = (uint16_t *)16; ECanaRegs.q = 3; *(volatile uint32_t *)&ECanaRegs.r = 17;
    ECanaRegs.o = ECanaRegs.o < 0 ? 18 : 19; (void)ECanaRegs.s;
    for (;;);
}
"""


def test_members_of_all_types_have_the_addresses_of_the_chip(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    seen = run(tmp_path, monkeypatch, MIXED)
    places = [
        ("W", 0x00, 1, 1), ("W", 0x02, 2, 0x20002), ("W", 0x04, 1, 1), ("W", 0x05, 1, 4), ("W", 0x08, 1, 5),
        ("W", 0x0A, 2, 0x60006), ("W", 0x0C, 1, 7), ("W", 0x12, 2, 0x80008), ("W", 0x14, 1, 9),
        ("W", 0x16, 2, 0xA000A), ("W", 0x17, 1, 11),
        ("R", 0x18, 1, 0), ("W", 0x18, 1, 12 << 8), ("R", 0x19, 1, 0), ("W", 0x19, 1, 13),
        ("R", 0x1A, 1, 0), ("W", 0x1A, 1, 14), ("W", 0x1B, 1, 15),
        ("W", 0x1C, 1, 0xFFFF), ("W", 0x1E, 2, 16), ("W", 0x20, 1, 1), ("W", 0x22, 2, 17),
        ("R", 0x1C, 1, 0xFFFF), ("W", 0x1C, 1, 18), ("R", 0x24, 2, 0),
    ]  # fmt: skip
    assert seen == [(how, FIRST + word, count, value) for how, word, count, value in places]


TIMER = """\
#include <stdint.h>
union TCR_REG { uint16_t all; struct { uint16_t : 4; uint16_t TSS : 1; } bit; };
struct CPUTIMER_REGS { uint32_t TIM, PRD; union TCR_REG TCR; };
extern volatile struct CPUTIMER_REGS CpuTimer0Regs;
typedef unsigned int Uint16; typedef unsigned long Uint32;
struct GPADAT_BITS { Uint16 GPIO0 : 1; Uint16 low : 15; Uint16 high : 15; Uint16 GPIO31 : 1; };
union GPADAT_REG { Uint32 all; struct GPADAT_BITS bit; };
extern volatile struct { union GPADAT_REG GPADAT, GPASET, GPACLEAR, GPATOGGLE; } GpioDataRegs;
int main(void) {
    int i;
    CpuTimer0Regs.PRD = 1000; CpuTimer0Regs.TCR.bit.TSS = 1;
    for (i = 0; i < 2; i++) {
        GpioDataRegs.GPASET.bit.GPIO31 = 1; GpioDataRegs.GPADAT.bit.GPIO0 = 1;
    }
    for (;;);
}
"""


def test_a_field_of_a_32_bit_register_is_an_access_of_its_half(tmp_path: Path):
    """This also holds the second time, when the layout of the store is already known."""
    (tmp_path / "main.c").write_text(TIMER)
    (tmp_path / "case.toml").write_text(CASE.format(undefined="false").replace('"GPIO"', '"GPIO", "TIMER0"'))
    records: list[Record] = []
    Scene(
        load(tmp_path / "case.toml", ["duration=100 us"]),
        lambda recorder, _: recorder.subscribe([Kind.ACCESS], records.append),
    ).run()
    seen = [(record.what, record.value) for record in records]
    bits = [("R GPIO.GPASET", 0), ("W GPIO.GPASET", 0x8000_0000), ("R GPIO.GPADAT", 0xF000), ("W GPIO.GPADAT", 0xF001)]
    assert seen == [("W TIMER0.PRD", 1000), ("R TIMER0.TCR", 0), ("W TIMER0.TCR", 0x10), *bits, *bits]


@pytest.mark.parametrize(
    ("members", "sentence"),
    [
        (
            "unsigned a : 14; unsigned b : 4; } bit;",
            "bit.b is not a register's: with the fields before it, its 4 bits cross",
        ),
        (
            "uint32_t a : 10; uint32_t b : 12; } bit;",
            "bit.b is not a register's: with the fields before it, its 12 bits",
        ),
        (
            "unsigned a : 8; unsigned : 16; unsigned b : 4; } bit;",
            "bit.b is not a register's: unnamed bits before it continue",
        ),
        (
            "unsigned char a : 5; unsigned char b : 5; } bit;",
            "bit.b is not a register's: with the fields before it, its 5",
        ),
        ("unsigned a : 8; unsigned b; } bit;", "bit.b is not a register's: bit fields before it end within a word"),
        (
            "unsigned a : 16; unsigned : 16; unsigned b; } bit;",
            "bit.b is not a register's: unnamed bits may be before it",
        ),
        (
            "uint16_t a : 16; uint16_t : 9; uint16_t b; } bit;",
            "bit.b is not a register's: unnamed bits may be before it",
        ),
        ("uint64_t a; } bit;", "bit.a is not a register's: no register has this type"),
        ("double a[2]; } bit;", "bit.a is not a register's: no register has this type"),
        (
            "uint_fast16_t a; } bit;",
            "bit.a is not a register's: uint_fast16_t is declared as long unsigned int, which has 32",
        ),
        ("unsigned long long a : 4; } bit;", "bit.a is not a register's: no register has this type"),
        (
            "union { int a; unsigned b; } c; } bit;",
            "bit.c.b is not a register's: another declaration of it has another type",
        ),
    ],
)
def test_a_member_of_unknown_position_is_refused_with_its_line(tmp_path: Path, members: str, sentence: str):
    text = f"#include <stdint.h>\nstruct REGS {{ struct {{\n{members} }};\nextern volatile struct REGS ECanaRegs;\n"
    source, library = tmp_path / "refused.c", tmp_path / "refused.so"
    source.write_text(text + "int main(void) { return *(volatile int *)&ECanaRegs; }\n")
    subprocess.run(["gcc", "-gdwarf-5", "-w", "-shared", "-fPIC", str(source), "-o", str(library)], check=True)
    with pytest.raises(BadLayout) as refused:
        RegisterLayout(library)
    assert str(refused.value).startswith(f"refused.c, line 3: ECanaRegs.{sentence}")


def test_a_refused_member_gives_one_sentence_of_the_case(tmp_path: Path):
    (tmp_path / "main.c").write_text(MIXED.replace("uint16_t k : 4", "uint16_t k : 4; uint16_t x : 13"))
    (tmp_path / "case.toml").write_text(CASE.format(undefined="false"))
    with pytest.raises(BadCase, match=r"main\.c, line 7: ECanaRegs\.fields\.") as refused:
        Scene(load(tmp_path / "case.toml"))
    assert "\n" not in str(refused.value)
