"""The log of an interrupted session: its complete lines are replayed, and the missing part is reported."""

from __future__ import annotations

import gc
import warnings
from pathlib import Path

import pytest

from periph_sim import BadCase, Case, Scene, load
from periph_sim.core.input_files import inputs_of_one_command, is_input
from periph_sim.core.phrases import did_you_mean
from periph_sim.interfaces.commands.live_case import files_of
from periph_sim.outside import Session, replay
from periph_sim.outside.live.case_for_line import case_for_line
from periph_sim.scene.case.party_tables import OutsideTable
from periph_sim.scene.outside_log import BadLog, LogReader
from tests.outside.live.echo import written
from tests.outside.sessions import Records, case


@pytest.fixture
def session(tmp_path: Path) -> Path:
    """Return the log of a session in which two bytes were sent."""
    log = tmp_path / "live.jsonl"
    with Session(case_for_line(written(tmp_path), "scia"), log=log) as session:
        line = session.serial("scia")
        session.advance(session.ticks("1 ms"))
        line.write(b"ab")
        session.advance(session.ticks("2 ms"))
        session.finish()
    return log


def test_a_log_cut_at_any_byte_is_read_to_its_last_complete_line_or_refused(session: Path) -> None:
    data, cut = session.read_bytes(), session.with_name("cut.jsonl")
    whole = list(LogReader(session).instants())
    assert len(whole) > 8 and data.isascii()
    for size in range(len(data)):
        cut.write_bytes(data[:size])
        lines = data[:size].count(b"\n")
        if lines < 3:  # the head, and the wire that is driven by bytes
            with pytest.raises(BadLog, match=rf"{cut.name}, line [123]: found no"):
                list(LogReader(cut).instants())
            continue
        reader = LogReader(cut)
        assert list(reader.instants()) == whole[: lines - 2]
        rest = size - data.rfind(b"\n", 0, size) - 1
        rest_text = f", and of the line after it only {rest} character{'s' * (rest > 1)} remain" if rest else ""
        ended = f"{cut} has no end: its session was ended before it was finished, so the replay ends with line {lines} "
        assert reader.unfinished == f"{ended}of the log{rest_text}"
    reader = LogReader(session)
    assert list(reader.instants()) == whole and not reader.unfinished


def test_a_log_that_is_read_is_an_input_that_outputs_cannot_replace(session: Path) -> None:
    with inputs_of_one_command():
        LogReader(session).close()
        assert is_input(session)


def test_a_killed_session_is_replayed_with_the_bytes_that_it_sent_and_a_note(session: Path, tmp_path: Path) -> None:
    lines = session.read_text().splitlines(keepends=True)
    session.write_text("".join(lines[:-1]) + lines[-1][:4])
    result = replay(case_for_line(tmp_path / "echo.toml", "scia"), session)
    assert result.sci_bytes == 2
    sentence = f"{session} has no end: its session was ended before it was finished, so the replay ends with line"
    assert [note.startswith(sentence) for note in result.notes] == [True]
    files, target = files_of(session, str(tmp_path / "again"))
    target.write_text(files[target])
    again = Scene(load(target)).run()
    assert again.sci_bytes == 2 and len(again.notes) == 1 and " has no end: " in again.notes[0]


def test_bytes_are_counted_on_the_wire_if_only_levels_are_logged(session: Path, tmp_path: Path) -> None:
    """A simulator drives RX by levels, without marking where a byte begins."""
    lines = [line for line in session.read_text().splitlines(keepends=True) if "serial" not in line]
    session.write_text("".join(line.replace(', ["RX"]]', "]") for line in lines))
    assert replay(case_for_line(tmp_path / "echo.toml", "scia"), session).sci_bytes == 2


@pytest.mark.parametrize(("length", "fits"), [((1 << 20) - 1, True), (1 << 20, False)])
def test_a_line_has_less_than_a_million_characters(session: Path, length: int, fits: bool) -> None:
    head = session.read_text().splitlines(keepends=True)[0]
    session.write_text(f'{head}{"[5, {}]":<{length - 1}}\n{{"end": 9}}\n')
    reader = LogReader(session)
    if fits:
        assert [instant.tick for instant in reader.instants()] == [5] and reader.end == 9
        return
    with pytest.raises(BadLog, match="line 2: found a damaged line, expected JSON"):
        list(reader.instants())


BUS = ("SDA", "SCL")


def logged(made: Case, log: Path, wires: tuple[str, ...]) -> Case:
    return made.model_copy(update={"outside": OutsideTable(wires=wires, log=str(log))})


def test_a_run_of_the_log_gives_the_records_of_the_session(tmp_path: Path) -> None:
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


def test_a_session_of_a_case_with_a_log_drives_the_wires_itself(tmp_path: Path) -> None:
    session = Session(logged(case(), tmp_path / "none.jsonl", BUS))
    session.advance(session.ticks("1 ms"))
    assert session.i2c.transfer(0x50, b"\x00", 2) == b"\x01\x02"


def test_a_log_is_closed_at_the_end_of_its_run(tmp_path: Path) -> None:
    (tmp_path / "live.jsonl").write_text(f'{HEAD}\n[1, {{"SDA": 0}}]\n{{"end": 9}}\n')
    made = logged(case(), tmp_path / "live.jsonl", BUS)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ResourceWarning)
        Scene(made).run(made.duration / 1000)
        gc.collect()
    assert not [one for one in caught if issubclass(one.category, ResourceWarning)]
