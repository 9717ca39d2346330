"""The website of the pages builds without a warning, has every page and a search index, and broken links are errors."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from tests.docs.pages import PAGES, ROOT


def built(root: Path, out: Path) -> subprocess.CompletedProcess[str]:
    """Build the site of the pages below `root`. pytest is hidden, because the workflow does not install it."""
    without = out.with_name("without")
    without.mkdir()
    (without / "pytest.py").write_text("raise ImportError\n", encoding="utf-8")
    command = [sys.executable, "-m", "mkdocs", "build", "--site-dir", str(out)]
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1", "PYTHONPATH": str(without)}
    return subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True, check=False)


def test_the_site_has_every_page_and_a_search_index(tmp_path: Path):
    done = built(ROOT, tmp_path / "site")
    assert done.returncode == 0, done.stderr
    assert "WARNING" not in done.stderr
    index = json.loads((tmp_path / "site" / "search" / "search_index.json").read_text(encoding="utf-8"))
    found = {entry["location"].partition("#")[0] for entry in index["docs"]}
    assert {f"{page.stem}/" for page in PAGES if page.parent.name == "docs"} | {"", "contributing/"} <= found
    anchors = {"keys/#unitnamestub", "limits/#which-exit-status-means-what"}  # as GitHub makes them
    assert anchors <= {entry["location"] for entry in index["docs"]}
    page = (tmp_path / "site" / "index.html").read_text(encoding="utf-8")
    assert 'href="fidelity/#how-fast"' in page and 'href="contributing/"' in page
    assert not re.search(r'(?:src|href)="https?://(?!squidfunk\.github\.io)', page)  # no request to another host


def test_broken_links_stop_the_build(tmp_path: Path):
    for name in ("docs", "README.md", "CONTRIBUTING.md", "mkdocs.yml"):
        aim = tmp_path / name
        shutil.copytree(ROOT / name, aim) if (ROOT / name).is_dir() else shutil.copy(ROOT / name, aim)
    (tmp_path / "tests" / "docs").mkdir(parents=True)
    shutil.copy(ROOT / "tests" / "docs" / "site.py", tmp_path / "tests" / "docs")
    with (tmp_path / "docs" / "why.md").open("a", encoding="utf-8") as page:
        page.write("[this](nowhere.md)\n\n[that](keys.md#nowhere)\n")
    done = built(tmp_path, tmp_path / "site")
    assert done.returncode != 0
    warnings = [line for line in done.stderr.splitlines() if line.startswith("WARNING")]
    assert len(warnings) == 2, done.stderr  # each of them alone stops a strict build
    assert "'nowhere.md'" in warnings[0] and "'keys.md#nowhere'" in warnings[1]
