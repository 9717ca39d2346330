"""The page on co-simulation: its bus, bench and test run as printed, and so does the replay."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from periph_sim.cosim.simulate import missing

PAGE = Path(__file__).parents[2] / "docs" / "cosimulation.md"


@pytest.mark.uncounted
def test_the_files_of_the_page_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if missing():
        pytest.skip(missing())
    pytest.importorskip("cocotbext.i2c")
    blocks = re.findall(r"`(\w+\.\w+)`:\n\n```\w+\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert [name for name, _ in blocks] == ["bus.v", "bench_bus.py", "test_bus.py"]
    for name, text in blocks:
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")]))
    bench: dict[str, object] = {}
    exec(blocks[2][1], bench)
    bench["test_bus"](tmp_path / "sim")  # type: ignore[operator]
    assert (tmp_path / "sim" / "run.vcd").stat().st_size > 1000
    bench_module: dict[str, object] = {}
    exec(blocks[1][1], bench_module)
    from periph_sim.outside import replay

    assert replay(bench_module["CASE"], tmp_path / "sim" / "outside.jsonl").wire_bytes == 7  # type: ignore[arg-type]
