"""Every picture in README and docs with a mark equals the output of its command."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.docs.pages import ROOT
from tests.docs.pictures import Picture, draw, pictures


@pytest.mark.long  # the commands run in other processes, whose lines are not counted
@pytest.mark.parametrize("picture", [*pictures()], ids=lambda picture: picture.file.stem)
def test_a_picture_equals_the_output_of_its_command(picture: Picture, tmp_path: Path):
    fresh = draw(picture, tmp_path)
    assert fresh == picture.file.read_text(encoding="utf-8"), "run `python -m tests.docs.update` and look at it"


def test_the_first_picture_is_in_the_readme():
    assert next(pictures()).page == ROOT / "README.md"


def test_a_command_that_draws_nothing_is_an_error_with_its_output(tmp_path: Path):
    picture = Picture(ROOT / "README.md", "periph-sim worst nothing.toml --svg .", "x.svg", tmp_path)
    with pytest.raises(ValueError, match=r"README\.md: `periph-sim worst .*` wrote no x\.svg:\nError: nothing\.toml"):
        draw(picture, tmp_path)
