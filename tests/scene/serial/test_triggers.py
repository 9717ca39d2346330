"""When characters from a line set something off: at the end of the last one of the text that is waited for."""

from __future__ import annotations

import pytest

from periph_sim.bus.uart.reader import Heard
from periph_sim.scene.serial.triggers import TextTrigger


@pytest.mark.parametrize(
    ("wanted", "line", "marks"),
    [
        (b"OK", "xOKxOK", "  ^  ^"),
        (b"OK", "OOKK", "  ^ "),
        (b"aba", "ababab", "  ^   "),  # the second one overlaps the first
        (b"aa", "aaaaa", " ^ ^ "),
        (b"a", "aba", "^ ^"),
        (b"OK", "O?K.OK", "     ^"),  # a wrong character in the text
    ],
)
def test_a_text_sets_off_at_its_last_character(wanted: bytes, line: str, marks: str):
    """Characters end at ticks 100, 200, 300 ...; a ? is a wrong one."""
    came: list[int] = []
    trigger = TextTrigger(wanted, came.append)
    for number, character in enumerate(line, 1):
        trigger.character(Heard(100 * number - 90, 100 * number, ord(character), character != "?", 0))
    assert came == [100 * number for number, mark in enumerate(marks, 1) if mark == "^"]
