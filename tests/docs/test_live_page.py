"""The picture of docs/live.md shows the current page."""

from __future__ import annotations

from tests.docs.live_picture import PAGE, PICTURE, digest_now
from tests.docs.photographs import digest_in


def test_the_picture_shows_the_current_page() -> None:
    assert digest_in(PICTURE.read_bytes()) == digest_now(), "run `python -m tests.docs.update live` and look at it"
    assert "(pictures/live.png)" in PAGE.read_text(encoding="utf-8")
