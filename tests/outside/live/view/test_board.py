"""The board between a session's thread and the readers of its snapshots."""

from __future__ import annotations

import threading

import pytest

from periph_sim.outside.live.view.board import Board


@pytest.fixture
def board() -> Board:
    return Board()


def test_a_reader_is_given_what_is_newer_than_what_it_has(board: Board) -> None:
    assert board.after(0, 0.0) == (0, None)
    board.put({"round": 1})  # type: ignore[typeddict-item]
    board.put({"round": 2})  # type: ignore[typeddict-item]
    assert board.after(0, 0.0) == board.after(1, 0.0) == (2, {"round": 2})
    assert board.after(2, 0.0) == (2, None)


@pytest.mark.parametrize("news", [lambda board: board.put({}), Board.close])
def test_a_reader_that_waits_is_woken(board: Board, news) -> None:
    came: list[int] = []
    reader = threading.Thread(target=lambda: came.append(board.after(0, 60.0)[0]))
    reader.start()
    news(board)
    reader.join(30)
    assert came == [0 if board.closed else 1]


def test_it_is_closed_once_it_is_told(board: Board) -> None:
    assert board.closed is False
    board.close()
    assert board.closed is True
