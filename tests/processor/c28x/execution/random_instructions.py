"""Run random instructions of every form, and print a digest of the results.

    python -m tests.processor.c28x.execution.random_instructions COUNT [SEED] [FROM TO]

The digest covers registers, memory writes and cycles, or the refusal, after each pass of each instruction. One line is
printed for each BLOCK instructions; with FROM and TO, the full results of these instructions are printed instead, to
find the first difference between two runs.
"""

from __future__ import annotations

import random
import sys
from collections.abc import Iterator, Sequence
from hashlib import blake2b

from periph_sim import form
from periph_sim.processor.c28x.decoder import decode
from periph_sim.processor.c28x.encodings import Encoding, encodings
from periph_sim.processor.c28x.execution.registers import IllegalOperation
from tests.processor.c28x.execution.flat import Flat

AT = 0x8000
BLOCK = 1000
ENDS = (0, 1, 0x7FFF, 0x8000, 0xFFFF, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FFFF)
FLOATS = (0, 0x8000_0000, 0x3F80_0000, 0x7F80_0000, 0xFF80_0001, 0x0080_0000, 0x0000_0001, 0x7F7F_FFFF, 0xC2F6_E979)
FORMS = [row for row in encodings() if not row.alias_of]


class Scattered(Flat):
    """A CPU whose memory, where nothing was written, reads as a word computed from the address."""

    def __init__(self) -> None:
        super().__init__()
        self.stores: list[tuple[int, int]] = []

    def load16(self, address: int) -> int:
        return self.memory.get(address, address * 0x9E37 >> 3 & 0xFFFF)

    def store16(self, address: int, value: int) -> None:
        self.stores.append((address, value))
        super().store16(address, value)

    def stop(self) -> None:
        """Do nothing, so that execution continues."""


def pair_of(row: Encoding, draw: random.Random) -> int:
    """Return two random words that are an instruction of this form."""
    while True:
        pair = row.value | draw.getrandbits(32) & ~row.mask
        if decode(pair >> 16, pair & 0xFFFF) is row:
            return pair


def number(draw: random.Random) -> int:
    return draw.choice(ENDS) if draw.random() < 0.3 else draw.getrandbits(32)


def float_bits(draw: random.Random) -> int:
    """Return a special value, one near 1 (so that sums are rounded and have a fraction) or any other, as bits."""
    near = draw.getrandbits(1) << 31 | draw.randrange(112, 142) << 23 | draw.getrandbits(23)
    return draw.choice((draw.choice(FLOATS), near, draw.getrandbits(32)))


def stir(cpu: Scattered, draw: random.Random) -> None:
    """Set registers to random values, so that the result of one instruction does not determine all that follow."""
    cpu.acc, cpu.p, cpu.xt = number(draw), number(draw), number(draw)
    cpu.xar = [number(draw) for _ in range(8)]
    cpu.r = [float_bits(draw) for _ in range(8)]
    cpu.put_st0(draw.getrandbits(16))
    cpu.sp, cpu.dp, cpu.rpc = draw.randrange(0x400, 0x7F00), draw.getrandbits(16), draw.getrandbits(22)
    cpu.stf = cpu.stf & 1 << 31 | draw.getrandbits(10) & 0x27F
    cpu.memory.clear()


def passes(count: int, seed: int | str, forms: Sequence[Encoding] = FORMS) -> Iterator[str]:
    """Yield the state after each pass of `count` instructions; every form occurs in turn."""
    draw, cpu = random.Random(seed), Scattered()
    order: list[Encoding] = []
    for at in range(count):
        if not order:
            order = list(forms)
            draw.shuffle(order)
        if at % 4 == 0:
            stir(cpu, draw)
        row = order.pop()
        pair = pair_of(row, draw)
        cpu.pc, cpu.repeat, cpu.passes = AT, -1, 0
        cpu.memory[AT], cpu.memory[AT + 1] = pair >> 16, pair & 0xFFFF
        cpu.written(AT)
        cpu.written(AT + 1)
        cpu.left = 3 if row.repeated and draw.random() < 0.25 else 0
        cpu.rb = draw.getrandbits(32) if draw.random() < 0.1 else 0
        while True:
            cpu.stores.clear()
            try:
                taken: int | str = cpu.step()
            except IllegalOperation as refused:
                taken, cpu.left = str(refused), 0
            yield (
                f"{at} {row.id} {pair:08x} {taken} {cpu.acc:x} {cpu.p:x} {cpu.xt:x} {list(cpu.xar)} {cpu.dp:x} "
                f"{cpu.sp:x} {cpu.rpc:x} {cpu.pc:x} {cpu.st0():x} {cpu.whole_st1():x} {cpu.ier:x} {cpu.ifr:x} "
                f"{cpu.dbgier:x} {list(cpu.r)} {cpu.stf:x} {cpu.rb:x} {cpu.repeat} {cpu.left} {cpu.ea} {cpu.stores}"
            )
            if not cpu.left or cpu.pc != AT:
                break


def digests(count: int, seed: int = 1) -> list[str]:
    """Return the name of the form that runs (compiled or interpreted), then one digest for each BLOCK instructions."""
    digest, lines, begun = blake2b(digest_size=12), [form.running], 0
    for line in passes(count, seed):
        at = int(line.split(" ", 1)[0])
        if at // BLOCK > begun:
            lines.append(f"{begun * BLOCK} {digest.hexdigest()}")
            begun = at // BLOCK
        digest.update(line.encode())
    return [*lines, f"{begun * BLOCK} {digest.hexdigest()}"]


def main() -> None:
    numbers = [int(text) for text in sys.argv[1:]]
    count, seed = numbers[0], numbers[1] if len(numbers) > 1 else 1
    if len(numbers) == 4:
        print(
            *(line for line in passes(count, seed) if numbers[2] <= int(line.split(" ", 1)[0]) < numbers[3]), sep="\n"
        )
    else:
        print(*digests(count, seed), sep="\n")


if __name__ == "__main__":
    main()
