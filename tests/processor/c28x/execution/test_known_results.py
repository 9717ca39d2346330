"""In random states each form of instruction behaves as it did when its digest was recorded.

    form --> TIMES random instructions --> text, flow, hazards; registers, memory, cycles --> digest <--> known_results

This is no independent check: other tests of this folder judge the results. This one notices any change of them, even in
cases that no other test reaches. After an intended change, `python -m
tests.processor.c28x.execution.test_known_results` writes the file anew, and the commit explains the forms that changed.
"""

from __future__ import annotations

from collections.abc import Iterator
from hashlib import blake2b
from pathlib import Path

from periph_sim.processor.c28x.decoder import Instruction
from periph_sim.processor.c28x.delay_slots import late_results, read_registers
from periph_sim.processor.c28x.encodings import Encoding
from periph_sim.processor.c28x.execution.operations import operation
from periph_sim.processor.c28x.pipeline import hazards, is_held, writes_at_once
from tests.processor.c28x.execution.random_instructions import AT, FORMS, passes

KNOWN = Path(__file__).with_name("known_results.txt")
TIMES = 40


def static(row: Encoding, pair: int) -> str:
    """Return properties of an instruction that need no execution, as text."""
    one = Instruction(AT, pair, row)
    f = operation(one)
    needs, makes = hazards(row, f.l, f.n, f.m)
    flow = (one.target, one.goes_on, one.is_call, late_results(one), read_registers(one))
    return f"{one.text} {one.words} {flow} {needs:x} {makes:x} {is_held(row)} {writes_at_once(row)}"


def digest(lines: Iterator[str]) -> str:
    made = blake2b(digest_size=4)
    for line in lines:
        made.update(f"{line}\n".encode())
    return made.hexdigest()


def known() -> dict[str, str]:
    """Return two digests of each form: of its static properties, and of its execution."""
    found = {}
    for row in FORMS:
        lines = [*passes(TIMES, row.id, [row])]
        pairs = dict.fromkeys(int(line.split(" ", 3)[2], 16) for line in lines)
        found[row.id] = f"{digest(static(row, pair) for pair in pairs)} {digest(iter(lines))}"
    return found


def test_each_form_has_its_recorded_digests():
    before = dict(line.split(" ", 1) for line in KNOWN.read_text(encoding="utf-8").splitlines())
    now = known()
    assert {name: (before.get(name), found) for name, found in now.items() if found != before.get(name)} == {}
    assert before.keys() == now.keys()


if __name__ == "__main__":
    KNOWN.write_text("".join(f"{name} {found}\n" for name, found in known().items()), encoding="utf-8")
