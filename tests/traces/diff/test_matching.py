"""Which transfer is like which: by words in common, by addresses, by shape."""

from __future__ import annotations

import pytest

from periph_sim.traces.diff.matching import ENOUGH, is_similar, similar_runs
from tests.traces.diff.runs import group

READ_68 = "START 0, address 68 R 1, ACK 2, byte 01 3, ACK 4, byte 02 5, NACK 6, STOP 7"


@pytest.mark.parametrize(
    ("other", "share"),
    [
        (READ_68, 1.0),
        (READ_68.replace("byte 02", "byte 03"), 7 / 8),
        ("START 0, address 68 R 1, NACK 2, STOP 3", 2 * 4 / 12),
        ("START 0, address 53 W 1, NACK 2, STOP 3", 2 * 3 / 12),
        ("START 0, address 53 W 1, ACK 2, byte 11 3, ACK 4, byte 22 5, ACK 6, byte 33 7, ACK 8", 2 * 3 / 17),
        ("START 0, address 68 R 1, ACK 2, byte 11 3", ENOUGH),  # the same address, and in fact half
        ("START 0, address 1E W 1, ACK 2, byte 11 3, ACK 4, byte 22 5, NACK 6, STOP 7", 5 / 8),
        ("STOP 0", 2 / 9),
    ],
)
def test_how_alike_two_transfers_are(other, share):
    assert is_similar(group(READ_68), group(other)) == pytest.approx(share)
    assert is_similar(group(other), group(READ_68)) == pytest.approx(share)


def test_one_shape_is_enough_with_no_word_in_common():
    assert is_similar([group("byte 41 0")[0]], [group("byte 42 0")[0]]) == ENOUGH
    assert is_similar([group("byte 41 0")[0]], [group("STOP 0")[0]]) == 0


def test_of_all_ways_to_pair_the_one_with_most_likeness():
    a = [group(READ_68), group(READ_68.replace("byte 01", "byte 77"))]
    b = [
        group(READ_68.replace("byte 01", "byte 77").replace("byte 02", "byte 78")),
        group("START 0, address 1E W 1, ACK 2"),
    ]
    assert [(run.a, run.b) for run in similar_runs(a, b)] == [(1, 0)]
    assert [(run.a, run.b) for run in similar_runs(b, a)] == [(0, 1)]
    assert [(run.a, run.b) for run in similar_runs(a, a)] == [(0, 0), (1, 1)]
    assert similar_runs(a, []) == similar_runs([], a) == []
