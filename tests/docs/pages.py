"""Run the commands shown on a Markdown page as a reader would, and compare or update their outputs.

    ```console                        <!-- file: blink.py -->
    $ periph-sim run blink.toml       ```python
    ...                               ...
    ```                               ```

A console block is run line by line in a scratch folder that looks like the repository; a
block under a file mark is written there before. In shown output, `...` matches anything
within a line, and a line that is only `...` matches any number of lines.

Commands that share no file of that folder are independent: each group of commands with shared files is a `Run`, which
is a test of its own, so that a page is tested by several cores, and commands of several pages are run once. A page that
creates a project is one run.

    page --> commands --shared files--> runs;  equal runs of all pages --> one Run with the text of each page
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from tests.docs.warm import folder_of_commands

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
SHARED = ("timing", "traces", "firmware", "docs")
WIDTH = "80"

CONSOLE = re.compile(r"^```console\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"^<!-- file: (\S+) -->\n```\w+\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NAME = re.compile(r"[\w/]*\w\.(?:asm|csv|fst|html|json|out|psr|py|sr|svg|toml|txt|vcd)\b")  # the name of a file


class Run(NamedTuple):
    """Commands that are run one after the other in one folder, with the (name, text) of its `files`.

    `shown` has, for the stem of each page with these commands, the output under each command.
    """

    commands: tuple[str, ...]
    files: tuple[tuple[str, str], ...]
    shown: dict[str, tuple[str, ...]]


def scratch(page: str, folder: Path) -> None:
    """Make `folder` look like the repository, and write the files of the page to it."""
    desk(folder, FILE.findall(page))


def desk(folder: Path, files: Iterable[tuple[str, str]]) -> None:
    """Make `folder` look like the repository, with these files (name, text) in it."""
    for name in SHARED:
        (folder / name).symlink_to(ROOT / name)
    for name, text in files:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")


def runs_of(pages: Iterable[Path]) -> list[Run]:
    """Return the runs of all commands of the pages that are to be run."""
    found: dict[tuple[tuple[str, ...], tuple[tuple[str, str], ...]], Run] = {}
    for page in pages:
        text = page.read_text(encoding="utf-8")
        files = dict(FILE.findall(text))
        shown = [one for block in CONSOLE.findall(text) for one in commands(block) if runs(one[0])]
        named = [_named(command, files) for command, _ in shown]
        for_all = {Path(name).name for name in files} - set().union(*named)  # pytest.ini
        makes_project = any(command.startswith("periph-sim new ") for command, _ in shown)
        for group in [list(range(len(shown)))] if makes_project else _sharing(named):
            ran = tuple(shown[place][0] for place in group)
            names = for_all.union(*(named[place] for place in group))
            there = tuple((name, text) for name, text in files.items() if Path(name).name in names)
            one = found.setdefault((ran, there), Run(ran, there, {}))
            one.shown[page.stem] = tuple(shown[place][1] for place in group)
    return list(found.values())


def _named(command: str, files: dict[str, str]) -> set[str]:
    """Return the names, without folders, of the scratch files that a command names, directly or through such a file."""
    texts = {Path(name).name: text for name, text in files.items()}
    names: set[str] = set()
    more = [command]
    while more:
        new = {Path(name).name for name in NAME.findall(more.pop()) if not name.startswith(SHARED)} - names
        names |= new
        more += [texts[name] for name in new if name in texts]
    return names


def _sharing(names: list[set[str]]) -> list[list[int]]:
    """Return groups of places whose sets share a name, directly or through another set."""
    groups: list[tuple[set[str], list[int]]] = []
    for place, own in enumerate(names):
        meeting = [group for group in groups if group[0] & own]
        groups = [group for group in groups if group not in meeting]
        groups.append((own.union(*(group[0] for group in meeting)), [*(p for g in meeting for p in g[1]), place]))
    return [sorted(places) for _, places in groups]


def commands(block: str) -> Iterator[tuple[str, str]]:
    """Yield the commands of a console block, each with the output shown under it."""
    for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
        command, _, shown = part.partition("\n")
        yield command, shown


def runs(command: str) -> bool:
    return command.startswith(("periph-sim ", "pytest ", "sed "))


def output(command: str, folder: Path) -> str:
    """Return the output of the command in a shell in `folder`, without trailing blanks."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"
    path = f"{folder_of_commands(path, ROOT)}{os.pathsep}{path}"
    done = subprocess.run(
        ["bash", "-c", command],
        cwd=folder,
        env={
            "PATH": path,
            "PYTHONPATH": str(ROOT),  # the code of this repository, whatever is installed
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


def written(page: Path, command: str, name: str, folder: Path) -> str:
    """Return the text of the file that a page's command writes. Raise ValueError with its output if it writes none."""
    scratch(page.read_text(encoding="utf-8"), folder)
    printed = output(command, folder)
    if not (folder / name).is_file():
        raise ValueError(f"{page.relative_to(ROOT)}: `{command}` wrote no {name}:\n{printed}")
    return (folder / name).read_text(encoding="utf-8")


def matches(shown: str, result: str) -> bool:
    """True if the output matches what the page shows."""
    pattern = ""
    for line in shown.splitlines():
        if line == "...":
            pattern += r"(?:.*\n)*"
        else:
            pattern += ".*".join(re.escape(part) for part in line.split("...")) + r"\n"
    return re.fullmatch(pattern, result) is not None


def fitted(shown: str, result: str) -> str:
    """Return the text for the page: `shown`, with new figures if only figures differ, or else the whole output."""
    if matches(shown, result):
        return shown
    lines = shown.splitlines()
    pattern = ""
    for line in lines:
        parts = (f"({_figures_apart(part)})" for part in line.split("..."))
        pattern += r"(?:.*\n)*?" if line == "..." else ".*".join(parts) + r"\n"
    found = re.fullmatch(pattern, result)
    if found is None:
        return result
    parts = iter(found.groups())
    printed = (line if line == "..." else "...".join(next(parts) for _ in line.split("...")) for line in lines)
    return "".join(f"{line}\n" for line in printed)


def _figures_apart(text: str) -> str:
    """Return a pattern for the text with other figures and other column widths."""
    loose = {"0": r"\d+", " ": " +", "─": "─+"}
    pieces = re.findall(r"\d+| +|─+|[^\d ─]+", text)
    return "".join(loose.get("0" if piece.isdecimal() else piece[0]) or re.escape(piece) for piece in pieces)


def refreshed(page: str, folder: Path) -> str:
    """Return the page with the new outputs of its commands; text left out as `...` stays left out if possible."""
    scratch(page, folder)

    def block(found: re.Match[str]) -> str:
        lines = ""
        for command, shown in commands(found[1]):
            if runs(command):
                result = output(command, folder)
                shown = fitted(shown, result)
            lines += f"$ {command}\n{shown}"
        return f"```console\n{lines}```"

    return CONSOLE.sub(block, page)
