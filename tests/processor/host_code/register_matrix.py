"""A matrix of statements on registers in C, and the register accesses that each of them makes.

Each row of the matrix is a register whose union has the whole (`all`), its 16-bit words if it has two (`half`) and bit
fields (`bit`): a field `f` of one width and position, and fields `lo`, `hi` and `rest` for the other bits. The
statements of `STATEMENTS` are executed on each of them. Their accesses are computed here from the rules of C and three
rules of the chip: a read of a field is a read of its word; a write of a field is a read and a write of its word, or
only a write if the field is the whole word; anything else is one access of the number's width.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from random import Random

FIRST = 0x6000  # address of the registers, in a frame without modelled modules, which keeps what is written
Access = tuple[str, int, int, int]  # R or W, address, words, value

# declared types of the fields, of the whole and of the halves; bits of the whole; True if the fields are signed
TYPES = {
    "unsigned int": ("unsigned int", "unsigned int", "", 16, False),
    "uint16_t": ("uint16_t", "uint16_t", "", 16, False),
    "unsigned short": ("unsigned short", "unsigned short", "", 16, False),
    "int": ("int", "int", "", 16, True),
    "enum": ("enum state", "unsigned int", "", 16, False),
    "unsigned int in unsigned long": ("unsigned int", "unsigned long", "unsigned int", 32, False),
    "uint16_t in uint32_t": ("uint16_t", "uint32_t", "uint16_t", 32, False),
    "unsigned long": ("unsigned long", "unsigned long", "unsigned int", 32, False),
    "uint32_t": ("uint32_t", "uint32_t", "uint16_t", 32, False),
    "enum in uint32_t": ("enum state", "uint32_t", "uint16_t", 32, False),
}
WIDTHS = (2, 3, 5, 7, 8, 9, 12, 15, 16)
SHAPES = [(bit, 1) for bit in range(16)] + sorted(
    {(bit, width) for width in WIDTHS for bit in (0, 1, 4, 6, 8, 16 - width) if bit + width <= 16}
)


@dataclass
class Chip:
    """Memory that keeps what registers are written, and the accesses so far."""

    words: dict[int, int] = field(default_factory=dict)
    log: list[Access] = field(default_factory=list)

    def read(self, word: int, count: int = 1) -> int:
        value = sum(self.words.get(word + index, 0) << 16 * index for index in range(count))
        self.log.append(("R", word, count, value))
        return value

    def write(self, word: int, value: int, count: int = 1) -> None:
        value &= (1 << 16 * count) - 1
        for index in range(count):
            self.words[word + index] = value >> 16 * index & 0xFFFF
        self.log.append(("W", word, count, value))


@dataclass(frozen=True)
class Field:
    name: str
    word: int
    bit: int
    width: int
    signed: bool

    def value(self, number: int) -> int:
        """Return the number that the field holds after `number` was assigned to it."""
        number &= (1 << self.width) - 1
        return number - (1 << self.width) if self.signed and number >> self.width - 1 else number

    def get(self, chip: Chip) -> int:
        return self.value(chip.read(self.word) >> self.bit)

    def put(self, chip: Chip, number: int) -> None:
        mask = (1 << self.width) - 1
        old = 0 if self.width == 16 else chip.read(self.word)
        chip.write(self.word, old & ~(mask << self.bit) | (number & mask) << self.bit)


@dataclass(frozen=True)
class Register:
    """A register of the matrix.

    place: the C expression of the register.
    number: the C type of the whole.
    fields: its fields, `f` first.
    """

    place: str
    word: int
    count: int
    fields: tuple[Field, ...]
    number: str
    halves: bool


def declared(kind: str, shape: tuple[int, int], half: int, name: str, word: int) -> tuple[str, Register]:
    """Return the declaration of a union of this name, and its register, which `Regs` has as a member at this word."""
    of_field, whole, of_half, bits, signed = TYPES[kind]
    begin, width = shape
    parts = [("lo", 0, begin), ("f", begin, width), ("hi", begin + width, 16 - begin - width)]
    members = [(part, half, bit, count) for part, bit, count in parts if count]
    if bits == 32:
        members.insert(0 if half else len(members), ("rest", 1 - half, 0, 16))
    lines = "".join(f" {of_field} {part} : {count};" for part, _, _, count in members)
    halves = f" struct {{ {of_half} lsw; {of_half} msw; }} half;" if of_half else ""
    text = f"union {name} {{ {whole} all;{halves} struct {{{lines} }} bit; }};"
    fields = sorted((Field(part, word + at, bit, count, signed) for part, at, bit, count in members), key=_f_first)
    return text, Register(f"ECanaRegs.{name}", word, bits // 16, tuple(fields), whole, bool(of_half))


def _f_first(one: Field) -> bool:
    return one.name != "f"


# Statements in C and their effects: {r} is the register, {c} and {d} are numbers, OUT(...) is a write elsewhere.
Effect = Callable[[Chip, Register, int, int], "int | None"]


def assign(change: Callable[[int, int], int]) -> Effect:
    def effect(chip: Chip, register: Register, c: int, d: int) -> None:
        f = register.fields[0]
        f.put(chip, change(f.get(chip), c))

    return effect


def out(value: Callable[[int, int], int]) -> Effect:
    return lambda chip, register, c, d: value(register.fields[0].get(chip), register.fields[0].value(c))


def write(chip: Chip, register: Register, c: int, d: int) -> None:
    register.fields[0].put(chip, c)


def both(chip: Chip, register: Register, c: int, d: int) -> int:
    f, other = register.fields[0], register.fields[-1]
    return 1 if f.get(chip) == f.value(c) and other.get(chip) != other.value(d) else 2


def either(chip: Chip, register: Register, c: int, d: int) -> int:
    f, other = register.fields[0], register.fields[-1]
    return 1 if f.get(chip) == f.value(c) or other.get(chip) == other.value(d) else 2


def until(chip: Chip, register: Register, c: int, d: int) -> None:
    while register.fields[0].get(chip):
        register.fields[0].put(chip, 0)


def copy(chip: Chip, register: Register, c: int, d: int) -> None:
    other = register.fields[-1]
    other.put(chip, register.fields[0].get(chip))


def whole_or(chip: Chip, register: Register, c: int, d: int) -> None:
    chip.write(register.word, chip.read(register.word, register.count) | c, register.count)


STATEMENTS: dict[str, Effect] = {
    "{r}.all = {d};": lambda chip, r, c, d: chip.write(r.word, d, r.count),
    "{r}.bit.f = {c};": write,
    "OUT({r}.bit.f);": out(lambda f, c: f),
    "{r}.bit.f = number{c};": write,
    "{r}.bit.f ^= 1;": assign(lambda f, c: f ^ 1),
    "{r}.bit.f = ~{r}.bit.f;": assign(lambda f, c: ~f),
    "{r}.bit.f = !{r}.bit.f;": assign(lambda f, c: not f),
    "{r}.bit.f |= {c};": assign(lambda f, c: f | c),
    "{r}.bit.f &= {c};": assign(lambda f, c: f & c),
    "{r}.bit.f++;": assign(lambda f, c: f + 1),
    "--{r}.bit.f;": assign(lambda f, c: f - 1),
    "{r}.bit.f += {c};": assign(lambda f, c: f + c),
    "if ({r}.bit.f) OUT(1); else OUT(2);": out(lambda f, c: 1 if f else 2),
    "if (!{r}.bit.f) OUT(1); else OUT(2);": out(lambda f, c: 2 if f else 1),
    "if ({r}.bit.f == {v}) OUT(1); else OUT(2);": out(lambda f, c: 1 if f == c else 2),
    "if ({v} != {r}.bit.f) OUT(1); else OUT(2);": out(lambda f, c: 1 if f != c else 2),
    "if ({r}.bit.f < number{v}) OUT(1); else OUT(2);": out(lambda f, c: 1 if f < c else 2),
    "OUT({r}.bit.f ? 3 : 4);": out(lambda f, c: 3 if f else 4),
    "switch ({r}.bit.f) {{ case {v}: OUT(5); break; default: OUT(6); }}": out(lambda f, c: 5 if f == c else 6),
    "if ({r}.bit.f == {v} && {r}.bit.{o} != {w}) OUT(1); else OUT(2);": both,
    "if ({r}.bit.f == {v} || {r}.bit.{o} == {w}) OUT(1); else OUT(2);": either,
    "{r}.bit.{o} = {r}.bit.f;": copy,
    "{{ volatile union {u} *p = &{r}; p->bit.f = {c}; }}": write,
    "while ({r}.bit.f) {r}.bit.f = 0;": until,
    "{r}.all |= {c};": whole_or,
    "OUT({r}.all);": lambda chip, r, c, d: chip.read(r.word, r.count),
}
OF_HALVES: dict[str, Effect] = {
    "{r}.half.msw = {c};": lambda chip, r, c, d: chip.write(r.word + 1, c),
    "OUT({r}.half.lsw);": lambda chip, r, c, d: chip.read(r.word),
    "{r}.half.msw++;": lambda chip, r, c, d: chip.write(r.word + 1, chip.read(r.word + 1) + 1),
}
HEAD = """\
#include <stdint.h>
enum state { OFF, ON };
#define OUT(value) EQep2Regs.out = (unsigned int)(value)
extern volatile struct { unsigned int out; } EQep2Regs;
struct SYS_CTRL_REGS { unsigned int reserved[25], WDCR; };
extern volatile struct SYS_CTRL_REGS SysCtrlRegs;
static volatile int numberZERO;
"""
OUT = 0x6B40


def matrix(shapes: int = 1, every: int = 1) -> tuple[str, list[tuple[str, list[Access]]]]:
    """Return a C file, and its statements with their accesses: all 20 000, or a part with each pair of properties.

    shapes: each type has one of this many shapes, each time another one than the previous type.
    every: likewise each register has one of this many statements.
    """
    random, chip, word, turn = Random(1), Chip(), FIRST, 0
    unions, members, functions, statements = [], [], [], []
    for number, kind in enumerate(TYPES):
        for shape in SHAPES[number % shapes :: shapes]:
            for half in range(TYPES[kind][3] // 16):
                word += word % (TYPES[kind][3] // 16)
                name = f"R{len(unions)}"
                text, register = declared(kind, shape, half, name, word)
                unions.append(text)
                members.append(f"    union {name} {name};")
                word += register.count
                rows = []
                turn += 1
                templates = [*STATEMENTS.items(), *(OF_HALVES.items() if register.halves else ())]
                for template, effect in [templates[0], *templates[1 + turn % every :: every]]:
                    statement, accesses = _executed(random, chip, register, name, template, effect)
                    rows.append(f"    {statement}")
                    statements.append((f"{text} {statement}", accesses))
                functions.append(f"static void {name}(void) {{\n" + "\n".join(rows) + "\n}")
    assert word <= OUT
    registers = ["struct REGS {", *members, "};", "extern volatile struct REGS ECanaRegs;"]
    calls = "".join(f" R{index}();" for index in range(len(unions)))
    main = f'int main(void) {{ asm(" EALLOW"); SysCtrlRegs.WDCR = 0x68;{calls} for (;;); }}'
    return "\n".join([HEAD, *unions, *registers, *functions, main, ""]), statements


def _executed(
    random: Random, chip: Chip, register: Register, name: str, template: str, effect: Effect
) -> tuple[str, list[Access]]:
    """Return a statement with its numbers inserted, and its accesses."""
    f, other = register.fields[0], register.fields[-1]
    c, d = random.getrandbits(f.width), random.getrandbits(16 * register.count)
    numbers = {"c": c, "d": d, "v": f.value(c), "w": other.value(d), "r": register.place, "u": name, "o": other.name}
    begin = len(chip.log)
    value = effect(chip, register, c, d)
    if value is not None:
        chip.write(OUT, value)
    return template.format(**numbers).replace("number", "numberZERO + "), chip.log[begin:]
