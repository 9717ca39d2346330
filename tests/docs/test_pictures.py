"""Every picture of README and docs whose page says how it is drawn is what that command draws."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.docs.pages import ROOT
from tests.docs.pictures import Picture, draw, pictures


@pytest.mark.long  # commands are processes of their own, in which nothing counts lines
@pytest.mark.parametrize("picture", [*pictures()], ids=lambda picture: picture.file.stem)
def test_a_picture_is_what_its_command_draws(picture: Picture, tmp_path: Path):
    fresh = draw(picture, tmp_path)
    assert fresh == picture.file.read_text(encoding="utf-8"), "run `python -m tests.docs.update` and look at it"


def test_the_first_screen_of_the_readme_has_one():
    assert next(pictures()).page == ROOT / "README.md"


def test_a_command_that_draws_nothing_is_told_with_what_it_said(tmp_path: Path):
    picture = Picture(ROOT / "README.md", "periph-sim worst nothing.toml --svg .", "x.svg", tmp_path)
    with pytest.raises(ValueError, match=r"README\.md: `periph-sim worst .*` wrote no x\.svg:\nError: nothing\.toml"):
        draw(picture, tmp_path)
