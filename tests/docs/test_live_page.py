"""The picture of docs/live.md shows the page as it is now."""

from __future__ import annotations

from tests.docs.live_picture import PAGE, PICTURE, digest_now
from tests.docs.photographs import digest_in


def test_the_picture_is_of_the_page_as_it_is() -> None:
    assert digest_in(PICTURE.read_bytes()) == digest_now(), "run `python -m tests.docs.update live` and look at it"
    assert "(pictures/live.png)" in PAGE.read_text(encoding="utf-8")
