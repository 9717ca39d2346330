"""The commands shown on a page, run as a reader would run them: a Markdown page goes in, what it should show comes out.

    ```console                        <!-- file: blink.py -->
    $ periph-sim run blink.toml       ```python
    ...                               ...
    ```                               ```

A console block is run line by line in a scratch folder that looks like the repository; a
block under a file mark is first written there. In shown output `...` stands for anything
within a line, a line that is only `...` for any lines.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
SHARED = ("timing", "traces", "firmware", "docs")
WIDTH = "110"

CONSOLE = re.compile(r"^```console\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"^<!-- file: (\S+) -->\n```\w+\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def scratch(page: str, folder: Path) -> None:
    """Make `folder` look like the repository, and write the page's own files into it."""
    for name in SHARED:
        (folder / name).symlink_to(ROOT / name)
    for name, text in FILE.findall(page):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")


def commands(block: str) -> Iterator[tuple[str, str]]:
    """The commands of a console block, each with the output shown under it."""
    for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
        command, _, shown = part.partition("\n")
        yield command, shown


def runs(command: str) -> bool:
    return command.startswith(("periph-sim ", "pytest ", "sed "))


def output(command: str, folder: Path) -> str:
    """What a shell in `folder` prints for the command; lines without trailing blanks."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"
    done = subprocess.run(
        ["bash", "-c", command],
        cwd=folder,
        env={
            "PATH": path,
            "PYTHONPATH": str(ROOT),  # the code beside these pages, whatever is installed
            "COLUMNS": WIDTH,
            "TERM": "dumb",
            "LC_ALL": "C.UTF-8",
            "HOME": str(folder),
        },
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return "".join(f"{line.rstrip()}\n" for line in done.stdout.splitlines())


def matches(shown: str, came: str) -> bool:
    """Whether the output fits what the page shows."""
    pattern = ""
    for line in shown.splitlines():
        if line == "...":
            pattern += r"(?:.*\n)*"
        else:
            pattern += ".*".join(re.escape(part) for part in line.split("...")) + r"\n"
    return re.fullmatch(pattern, came) is not None


def fitted(shown: str, came: str) -> str:
    """What a page should show: as before if that fits, with new figures if no more has changed, else all that came."""
    if matches(shown, came):
        return shown
    lines = shown.splitlines()
    pattern = ""
    for line in lines:
        parts = (f"({_figures_apart(part)})" for part in line.split("..."))
        pattern += r"(?:.*\n)*?" if line == "..." else ".*".join(parts) + r"\n"
    found = re.fullmatch(pattern, came)
    if found is None:
        return came
    parts = iter(found.groups())
    told = (line if line == "..." else "...".join(next(parts) for _ in line.split("...")) for line in lines)
    return "".join(f"{line}\n" for line in told)


def _figures_apart(text: str) -> str:
    """A pattern for the text with other figures, and columns of other widths."""
    loose = {"0": r"\d+", " ": " +", "─": "─+"}
    pieces = re.findall(r"\d+| +|─+|[^\d ─]+", text)
    return "".join(loose.get("0" if piece.isdecimal() else piece[0]) or re.escape(piece) for piece in pieces)


def refreshed(page: str, folder: Path) -> str:
    """The page with the outputs that its commands give; what it leaves out as `...` stays left out where it can."""
    scratch(page, folder)

    def block(found: re.Match[str]) -> str:
        lines = ""
        for command, shown in commands(found[1]):
            if runs(command):
                came = output(command, folder)
                shown = fitted(shown, came)
            lines += f"$ {command}\n{shown}"
        return f"```console\n{lines}```"

    return CONSOLE.sub(block, page)
