"""A case whose outside is a log: a run of it makes the records of the session; a log that does not fit is refused."""

from __future__ import annotations

import gc
import warnings
from pathlib import Path

import pytest

from periph_sim.core.suggest import did_you_mean
from periph_sim.outside import Session
from periph_sim.scene.case.model import BadCase, Case, OutsideTable
from periph_sim.scene.scene import Scene
from tests.outside.sessions import Records, case

BUS = ("SDA", "SCL")


def logged(made: Case, log: Path, wires: tuple[str, ...]) -> Case:
    return made.model_copy(update={"outside": OutsideTable(wires=wires, log=str(log))})


def test_a_run_makes_the_records_of_the_session(tmp_path: Path) -> None:
    log, live, again = tmp_path / "live.jsonl", Records(), Records()
    made = case(
        "imu_hil",
        ("I2C-A", "SCI-A", "GPIO", "TIMER0", "TIMER1"),
        controller={"order": ["gyroscope"], "first": "5 ms", "period": "10 ms"},
        budget=[{"name": "in time", "measure": "round", "max": "5 ms"}],
    )
    session = Session(made, ("RX",), log=log, subscribe=live.subscribe)
    line = session.serial("scia")
    for _ in range(3):
        line.write(bytes(range(12)))
        session.advance(session.now + session.ticks("4 ms"))
    session.advance(session.ticks("15 ms"))  # and no further: a round would begin in this very tick
    result = session.finish()
    scene = Scene(logged(made, log, ("RX",)), again.subscribe)
    replayed = scene.run(scene.timebase.seconds(session.now))
    assert live.kept == again.kept and len(live.kept) > 300
    assert live.kept[-1].tick < session.ticks("15 ms")
    assert (replayed.counts, replayed.sci_bytes, replayed.wire_bytes, replayed.simulated_s) == (
        result.counts,
        36,
        result.wire_bytes,
        result.simulated_s,
    )
    assert replayed.budgets == result.budgets


HEAD = '{"format": "periph-sim outside", "version": 1, "case": "x", "ticks_per_second": 3000000000, "wires": ["SDA"]}'


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (None, "live.jsonl: No such file or directory; give the log of a session"),
        ("", "live.jsonl, line 1: found no head"),
        (f'{HEAD}\n[1, {{"SDA": 0}}]\n[', ""),
        (f"{HEAD}\n[1, 7]\n", "live.jsonl, line 2: found \\[1, 7\\], expected an instant"),
        (f'{HEAD}\n[1, {{"SDA": 2}}]\n', "line 2: found 'SDA': 2, expected 0 or 1 of SDA"),
        (f'{HEAD}\n[1, {{"SCL": 0}}]\n', "line 2: found 'SCL': 0, expected 0 or 1 of SDA"),
        (HEAD.replace("SDA", "RX") + "\n", f"it moves RX; {did_you_mean('RX', BUS)}"),
        (HEAD.replace("3000000000", "5") + "\n", "it has 5 ticks a second, and this case 3000000000"),
    ],
)
def test_a_log_that_does_not_fit_is_refused_before_the_run(text: str | None, sentence: str, tmp_path: Path) -> None:
    log = tmp_path / "live.jsonl"
    if text is not None:
        log.write_text(text)
    made = logged(case(), log, BUS)
    if not sentence:
        assert Scene(made).run(made.duration / 1000).sci_bytes == 0
        return
    with pytest.raises(BadCase, match=f"outside.log: .*{sentence}"):
        Scene(made)


def test_a_session_of_such_a_case_moves_the_wires_itself(tmp_path: Path) -> None:
    session = Session(logged(case(), tmp_path / "none.jsonl", BUS))
    session.advance(session.ticks("1 ms"))
    assert session.i2c.transfer(0x50, b"\x00", 2) == b"\x01\x02"


def test_a_log_is_open_no_longer_than_its_run(tmp_path: Path) -> None:
    (tmp_path / "live.jsonl").write_text(f'{HEAD}\n[1, {{"SDA": 0}}]\n{{"end": 9}}\n')
    made = logged(case(), tmp_path / "live.jsonl", BUS)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", ResourceWarning)
        Scene(made).run(made.duration / 1000)
        gc.collect()
    assert not [one for one in told if issubclass(one.category, ResourceWarning)]
