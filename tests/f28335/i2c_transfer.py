"""Transfers as tables with one column per byte: the master's actions, the firmware's accesses, the flags afterwards.

    > bus    S  48W  00  S  48R  11  22N  P
    > read   -  -    DRR -  -    -   -    -
    > DXR    -  -    -   -  11   22  -    -
    > clear  -  -    -   -  -    -   -    SCD
    < ack    -  0    0   -  0    -   -    -
    < SDIR   0  .    .   .  1    .   .    0

S is a START (also a repeated one), P a STOP, + a pause in which only the firmware acts; 48W and 48R are address bytes.
Two digits are a byte that the master writes or, after 48R, one that it must read and acknowledge; with an N it answers
with a NACK. In each column, the bus action ends at the ninth fall of SCL (a START or STOP at its edge of SDA); SOON
cycles later the firmware acts, and SOON cycles after that the flags are sampled. `>` rows are played; `<` rows are
results: ack is the ninth bit of a byte that the master sent, hold is 1 if the chip holds SCL low, asks is the code in
I2CISRC, and the others are flags of I2CSTR. "." means unchanged, "-" means none.
"""

from __future__ import annotations

from ..waves import Diagram, tidy
from .i2c_registers import FLAGS
from .i2c_rig import Rig

SOON = 40  # cycles


def play(table: str, rig: Rig) -> Diagram:
    """Play the `>` rows of a table on a rig, and return the table with the results of that run."""
    rows = [line.split() for line in tidy(table).splitlines()]
    words = rows[0][2:]
    assert rows[0][:2] == [">", "bus"], "the first row must be '> bus'"
    assert all(len(row) == len(rows[0]) for row in rows), f"rows of different length: {[len(row) for row in rows]}"
    came: list[list[str]] = [row[:2] for row in rows]
    last: dict[str, str] = {}
    reading = False
    for n, word in enumerate(words, 2):
        reading = word.endswith("R") or (reading and word not in ("S", "P"))
        played, ack = _play_word(rig, word, reading)
        rig.wait(SOON)
        for (way, name, *_), cell in ((row, row[n]) for row in rows[1:]):
            if way == ">" and cell != "-":
                _access(rig, name, cell)
        rig.wait(SOON)
        for row, out in zip(rows, came, strict=True):
            way, name = row[:2]
            shown = row[n]
            if name == "bus":
                shown = played
            elif way == "<":
                now = ack if name == "ack" else _flag(rig, name)
                shown = "." if last.get(name) == now and now != "-" else now
                last[name] = now
            out.append(shown)
    return _columns(came)


def _play_word(rig: Rig, word: str, reading: bool) -> tuple[str, str]:
    """Play a word; return the word as it occurred and the chip's acknowledge bit, "-" if the master sent no byte."""
    if word == "S":
        rig.start() if not rig.flag("BB") else rig.restart()
    elif word == "P":
        rig.stop()
    elif word == "+":
        pass
    elif word[-1] in "RW":
        return word, str(int(not rig.send(int(word[:-1], 16) << 1 | (word[-1] == "R"))))
    elif reading:
        nack = word.endswith("N")
        return f"{rig.read_byte(ack=not nack):02x}{'N' * nack}", "-"
    else:
        return word, str(int(not rig.send(int(word, 16))))
    return word, "-"


def _access(rig: Rig, name: str, cell: str) -> None:
    if name == "read":
        rig.read(f"I2C{cell}")
    elif name == "clear":
        rig.write("I2CSTR", FLAGS[cell])
    else:
        rig.write(f"I2C{name}", int(cell, 16))


def _flag(rig: Rig, name: str) -> str:
    if name == "hold":
        return str(int(rig.stretching))
    return f"{rig.peek('I2CISRC') & 7}" if name == "asks" else str(rig.flag(name))


def same(table: str) -> Diagram:
    """Return a table in the normalized form of the result of `play`."""
    return _columns([line.split() for line in tidy(table).splitlines()])


def _columns(rows: list[list[str]]) -> Diagram:
    widths = [max(len(row[n]) for row in rows) for n in range(len(rows[0]))]
    lines = ("  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)) for row in rows)
    return Diagram("\n".join(line.rstrip() for line in lines))
