"""A backlog of bytes for a client: it keeps the last ones up to its size, and passes them on while there is room."""

from __future__ import annotations

import pytest

from periph_sim.outside.live import backlog
from periph_sim.outside.live.backlog import Backlog, left_there


def test_bytes_beyond_the_size_of_a_backlog_are_discarded_and_counted() -> None:
    waiting = Backlog(5)
    waiting.add(b"abcde")
    assert (waiting.lost, len(waiting)) == (0, 5)
    waiting.add(b"fg")
    assert (waiting.lost, waiting.read(2), waiting.read(9), len(waiting)) == (2, b"cd", b"efg", 0)
    waiting.add(b"hi")
    waiting.clear()
    assert (waiting.lost, waiting.read(1)) == (2, b"")


@pytest.mark.parametrize("room", [BlockingIOError(), 0])
def test_a_backlog_is_passed_on_in_pieces_while_there_is_room(monkeypatch: pytest.MonkeyPatch, room: object) -> None:
    monkeypatch.setattr(backlog, "AT_ONCE", 4)
    waiting, offered, taken = Backlog(), [], iter([4, 1, room])
    waiting.add(b"abcdefg")

    def take(data: bytes) -> int:
        offered.append(data)
        count = next(taken)
        if isinstance(count, BlockingIOError):
            raise count
        return count

    waiting.flush(take)
    assert offered == [b"abcd", b"efg", b"fg"]
    assert waiting.read(9) == b"fg"


def test_sizes_of_a_backlog() -> None:
    assert (backlog.MOST, backlog.AT_ONCE, backlog.MOST_HELD) == (1 << 20, 4096, 16 << 20)


def test_bytes_left_in_the_system_are_counted_up_to_a_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    pieces = iter([b"abc", b"d", b""])
    assert left_there(lambda: next(pieces)) == 4
    monkeypatch.setattr(backlog, "MOST_HELD", 10)
    assert left_there(lambda: b"12345") == 10
