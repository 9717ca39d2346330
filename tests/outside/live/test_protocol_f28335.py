"""pyserial's `serial_for_url` opens a case, which behaves as a port; invalid URLs are refused."""

from __future__ import annotations

import gc
import threading
import time
from itertools import pairwise
from pathlib import Path
from typing import Any
from weakref import ref

import pytest

serial = pytest.importorskip("serial", reason="pyserial is not installed: the extra live has it")

import periph_sim.live  # noqa: E402
from periph_sim.outside import Session, replay  # noqa: E402
from periph_sim.outside.live import protocol_f28335  # noqa: E402
from periph_sim.outside.live.backlog import Backlog  # noqa: E402
from periph_sim.scene.outside_log import LogReader  # noqa: E402
from tests.outside.live.echo import written  # noqa: E402


def moves_of_rx(log: Path) -> list[tuple[int, int]]:
    """Return tick and level of each edge of RX in a log."""
    return [(tick, levels["RX"]) for tick, levels, _ in LogReader(log).instants() if "RX" in levels]


UNSENT = pytest.mark.filterwarnings("ignore:.* was closed before it had sent:RuntimeWarning")


def port(folder: Path, more: str = "&pace=0", **given: Any) -> Any:
    assert periph_sim.live.PACKAGE in serial.protocol_handler_packages
    return serial.serial_for_url(
        f"f28335://{written(folder)}?port=scia{more}", **{"timeout": 0.01, "baudrate": 115_200, **given}
    )


def test_a_plain_script_at_full_speed(tmp_path: Path, recwarn: pytest.WarningsRecorder) -> None:
    with port(tmp_path) as line:
        assert line.write(b"hello") == 5
        assert line.out_waiting == 5
        assert line.read(5) == b"ifmmp"
        assert (line.read(1), line.in_waiting) == (b"", 0)  # after ten simulated milliseconds
        line.write(b"a")
        line.flush()
        assert line.out_waiting == 0
        assert line.read() == b"b"
        assert line.read_until(b"x") == b""
    assert 0.02 < line.result.simulated_s < 0.03
    assert (line.result.sci_bytes, line.unsent, recwarn.list) == (6, 0, []), "flush has sent all bytes"


def test_each_byte_has_the_ninth_bit_of_the_parity_with_which_it_was_written(tmp_path: Path) -> None:
    with port(tmp_path, parity="M") as line:
        records: list[tuple[Any, ...]] = []
        frame = line._queue.line._frame
        line._queue.line._frame = lambda *given: records.append(given[1:]) or frame(*given)
        line.write(b"\x21")
        line.parity = "S"
        line.write(b"a")
        line.flush()
    assert records == [(0x21, "", 1), (ord("a"), "", 0)]


def test_waiting_bytes_are_counted_and_discarded_by_a_reset_of_the_input(tmp_path: Path) -> None:
    with port(tmp_path) as line:
        line.write(b"ab")
        line.flush()
        line._session.advance(line._session.now + line._session.ticks("1 ms"))
        assert line.in_waiting == 2
        line.reset_input_buffer()
        line.write(b"d")
        assert line.read(1) == b"e"


class InHours:
    """A session with steps of an hour; the 3.6 million steps of a millisecond would take too long."""

    def __init__(self, session: Session) -> None:
        self.advance, self.ticks_per_second, self._session = session.advance, session.ticks_per_second, session

    @property
    def now(self) -> int:
        return self._session.now

    def ticks(self, _: str) -> int:
        return 3600 * self.ticks_per_second


def test_a_read_without_time_out_ends_after_an_hour_of_simulated_time(tmp_path: Path) -> None:
    with port(tmp_path, timeout=None) as line:
        session = line._session
        line._session = InHours(session)
        assert (line.read(1), line.clock()) == (b"", 3600.0)
        line._session = session


def test_a_script_at_the_pace_of_a_clock(tmp_path: Path) -> None:
    line = port(tmp_path, "&pace=1", timeout=30)
    line.write(b"hello")
    assert line.read(5) == b"ifmmp"
    line.flush()
    line.close()
    line.close()
    assert line.result.sci_bytes == 5


@pytest.mark.parametrize("pace", [0, 1])
def test_unsent_bytes_at_the_end_are_counted_and_reported(tmp_path: Path, pace: int) -> None:
    """A character takes 8.3 ms at 1200 baud."""
    line = port(tmp_path, f"&pace={pace}", baudrate=1200)
    line.write(bytes(5000))
    assert line.in_waiting + line.out_waiting > 4000, "the line has not sent them"
    said = rf"&pace={pace} was closed before it had sent (4\d\d\d|5000) bytes; call flush\(\) first$"
    with pytest.warns(RuntimeWarning, match=said):
        line.close()
    assert (line.unsent + line.result.sci_bytes, line._queue.waits()) == (5000, 0)
    line.open()
    assert line.unsent == 0
    line.close()


@UNSENT
def test_a_flush_in_another_thread_ends_as_the_port_is_closed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    line = port(tmp_path, "&pace=1", baudrate=300)
    line.write(bytes(300))  # take ten seconds
    begun, waits = threading.Event(), line._queue.waits
    monkeypatch.setattr(line._queue, "waits", lambda: begun.set() or waits())
    flush = threading.Thread(target=line.flush, daemon=True)
    flush.start()
    assert begun.wait(30)
    line.close()
    flush.join(30)
    assert not flush.is_alive()


def test_the_clock_of_a_port_follows_its_pace(tmp_path: Path) -> None:
    with port(tmp_path, "&pace=2") as line:
        before = time.monotonic()
        assert 2 * before <= line.clock() <= 2 * time.monotonic()


def test_a_port_can_be_opened_again_and_its_log_can_be_replayed(tmp_path: Path, log: Path) -> None:
    line = port(tmp_path, f"&pace=0&log={log}")
    line.write(b"abc")
    assert line.read(3) == b"bcd"
    line.close()
    live = line.result
    again = replay(tmp_path / "echo.toml", log)
    assert (again.counts, again.simulated_s, again.sci_bytes) == (live.counts, live.simulated_s, 3)
    line.open()
    assert line.read(1) == b""
    line.close()
    assert line.result.sci_bytes == 0


def test_another_rate_corrupts_characters_until_it_is_corrected(tmp_path: Path) -> None:
    with port(tmp_path, baudrate=9600) as line:
        line.write(b"a")
        assert line.read(9) != b"b"
        line.baudrate = 115_200
        line.reset_input_buffer()
        line.send_break(0.0001)
        line.break_condition = True
        line.write(b"a")
        line.flush()
        assert line.cts is False


def test_a_rate_is_set_or_refused_if_impossible(tmp_path: Path) -> None:
    with port(tmp_path, baudrate=9600) as line:
        line.baudrate = 115_200
        line.write(b"a")
        assert line.read(1) == b"b"
        with pytest.raises(ValueError, match="10000000000 baud: expected 1 or more, and no bit shorter than a tick"):
            line.baudrate = 10_000_000_000


@pytest.mark.parametrize(
    ("baud", "count", "length", "least"),
    [
        (
            115_200,
            2000,
            0.05,
            3_000_000,
        ),  # after 174 ms; at least a millisecond, while in a frame RX is low for one bit only
        (50, 1, 0.2, 180_000_000),  # after 200 ms; at least 60 ms, which are three bits
    ],
)
def test_a_break_at_the_pace_of_a_clock_follows_the_bytes_written_before(
    tmp_path: Path, log: Path, baud: int, count: int, length: float, least: int
) -> None:
    """The break's end is requested `length` after its beginning, and the beginning must not wait for bytes then."""
    with port(tmp_path, f"&log={log}", baudrate=baud) as line:
        line.write(b"\xff" * count)
        line.send_break(length)
        line.flush()
    longest = max(after - before for (before, level), (after, _) in pairwise(moves_of_rx(log)) if level == 0)
    assert longest > least


def test_the_scene_of_a_closed_port_is_released(tmp_path: Path) -> None:
    line = port(tmp_path)
    scene = ref(line._session.scene)
    line.write(b"a")
    line.read(1)
    line.close()
    gc.collect()
    assert scene() is None and line.result.sci_bytes == 1


def test_a_break_has_its_length_in_simulated_time(tmp_path: Path, log: Path) -> None:
    with port(tmp_path, f"&pace=0&log={log}") as line:
        line.write(b"\xff")
        line.send_break(0.0002)
        line.read(100)
        line.send_break()
        line.timeout = 0.3
        line.read(1000)
        line.timeout = 0.01
        line.break_condition = True
        line.read(100)
        line.break_condition = False  # to release the break once is sufficient
        line.read(100)
        assert (line.cts, line.dsr, line.ri, line.cd) == (False,) * 4
    ticks, levels = zip(*moves_of_rx(log), strict=True)
    assert levels == (0, 1) * 4
    begin, end, broken, over, usual, usual_over, *_ = ticks
    bit = 3_000_000_000 // 115_200
    assert (end - begin, over - broken, usual_over - usual) == (bit, 600_000, 750_000_000), "pyserial's own are 0.25 s"
    assert broken - begin >= 10 * bit, "the frame has ended"


def test_a_break_waits_for_the_end_of_a_frame_and_of_an_earlier_break(tmp_path: Path, log: Path) -> None:
    """A frame takes 8.3 ms at 1200 baud."""
    with port(tmp_path, f"&pace=0&log={log}", baudrate=1200, timeout=0.02) as line:
        line.write(b"\xff\xff")
        line.break_condition = True
        line.break_condition = False
        line.send_break(0.01)
        line.read(100)
    begin, _, second, _, held, held_over, sent, over = (tick for tick, _ in moves_of_rx(log))
    bit = 3_000_000_000 // 1200
    assert (second - begin, held - second, held_over - held, over - sent) == (10 * bit, 10 * bit, bit, 30_000_000)
    assert sent >= held_over


def test_a_break_after_more_than_an_hour_of_bytes_is_refused_in_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(protocol_f28335, "FOREVER", 1)
    with port(tmp_path, baudrate=50) as line:
        line.write(b"a" * 8)  # 1.6 s
        with pytest.raises(serial.SerialException, match=r"^a break cannot begin: bytes are on their way after 1 sim"):
            line.send_break()
        line.flush()
        line.send_break()


@pytest.mark.parametrize(
    ("url", "sentence"),
    [
        ("f28335://", r"no case was given; f28335://PATH/OF/CASE.toml\?port=scia"),
        ("f28335://{}/no.toml", "no.toml: cannot be read"),
        ("f28335://{}/echo.toml?prot=scia", "there is no 'prot' in such a URL; it has port, pace, log"),
        ("f28335://{}/echo.toml?pace=fast", "pace 'fast': expected a number, as in pace=1"),
        ("f28335://{}/echo.toml?pace=-1", "pace -1: expected 0, as fast as it can, or more"),
        ("f28335://{}/echo.toml?port=scib", "there is no SCI 'SCI-B'; it has dsp.SCI-A"),
        ("f28335://{}/echo.toml?port=usb&pace=0", "there is no SCI 'usb'"),
    ],
)
def test_an_invalid_url_is_refused_in_one_sentence(url: str, sentence: str, tmp_path: Path) -> None:
    written(tmp_path)
    with pytest.raises(serial.SerialException, match=sentence):
        serial.serial_for_url(url.format(tmp_path))


def test_errors_of_a_closed_port_name_its_url(tmp_path: Path) -> None:
    line = port(tmp_path)
    with pytest.raises(serial.SerialException, match="open already"):
        line.open()
    line.close()
    resets = line.reset_input_buffer, line.reset_output_buffer
    for call in (line.read, line.flush, *resets, lambda: line.write(b"a"), lambda: line.in_waiting):
        with pytest.raises(serial.PortNotOpenError, match=r"pace=0 is closed; open\(\) restarts its case$"):
            call()


@pytest.mark.timeout(20)  # seconds; a client that is not woken would wait forever
@pytest.mark.parametrize("cycles", [45_000_000, 1000])  # 300 ms, so that the client already waits
def test_an_error_of_firmware_is_raised_in_the_client(tmp_path: Path, cycles: int) -> None:
    case = written(tmp_path)
    (tmp_path / "echo_firmware.py").write_text(f"def main(dsp, settings):\n    dsp.compute({cycles})\n    1 / 0\n")
    line = serial.serial_for_url(f"f28335://{case}?pace=1", timeout=None)
    with pytest.raises(serial.SerialException, match=r"ZeroDivisionError at line 3 of echo_firmware.py"):
        line.read(1)  # ends with the firmware, if that has not failed yet
        line.read(1)
    line.close()


def test_an_error_of_firmware_at_full_speed_is_raised_in_the_client(tmp_path: Path) -> None:
    case = written(tmp_path)
    (tmp_path / "echo_firmware.py").write_text("def main(dsp, settings):\n    dsp.compute(1000)\n    1 / 0\n")
    with serial.serial_for_url(f"f28335://{case}?pace=0", timeout=1) as line:
        line.write(b"a")
        for call in (line.flush, line.read, lambda: line.write(b"a"), lambda: line.in_waiting):
            with pytest.raises(serial.SerialException, match=r"ZeroDivisionError at line 3 of echo_firmware.py"):
                call()
    assert line.result.simulated_s < 0.001


@UNSENT
@pytest.mark.timeout(30)  # seconds; a client that waits for room that never comes would loop
@pytest.mark.parametrize("pace", [0, 1000])
def test_writing_more_than_the_line_accepts_blocks_and_loses_nothing(tmp_path: Path, monkeypatch, pace: int) -> None:
    monkeypatch.setattr(protocol_f28335, "MOST", 20)
    with port(tmp_path, f"&pace={pace}", write_timeout=None if pace else 0.1) as line:
        assert line.write(bytes(range(100))) == 100
        assert line.out_waiting <= 20
        if not pace:
            line.write_timeout = 0.0001
            with pytest.raises(
                serial.SerialTimeoutException, match="of 60 bytes were written, and a megabyte waits; w"
            ):
                line.write(bytes(60))
            line.timeout = 1
        else:
            line.timeout = 30
            assert line.read(100) == bytes(range(1, 101))


@UNSENT
def test_a_blocked_write_ends_at_its_timeout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A character takes 200 ms at 50 baud."""
    monkeypatch.setattr(protocol_f28335, "MOST", 1)
    with port(tmp_path, baudrate=50, write_timeout=0.02) as line:
        line.write(b"a")
        begun = line.clock()
        with pytest.raises(serial.SerialTimeoutException):
            line.write(b"bcd")
        assert 0.02 <= line.clock() - begun < 0.04


@UNSENT
def test_at_the_pace_of_a_clock_the_timeout_of_a_write_is_real_time(tmp_path: Path, monkeypatch) -> None:
    """20 characters take 4.4 simulated seconds at 50 baud, which are 44 ms of real time."""
    monkeypatch.setattr(protocol_f28335, "MOST", 1)
    with port(tmp_path, "&pace=100", baudrate=50, write_timeout=3) as line:
        assert line.write(bytes(20)) == 20


def test_discarded_unread_bytes_are_counted_and_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(protocol_f28335, "Backlog", lambda: Backlog(10))
    line = port(tmp_path, timeout=1)
    line.write(b"abcdefghijklmnopqrst")
    assert line.read(20) == b"lmnopqrstu"
    with pytest.warns(RuntimeWarning, match="10 unread bytes of the SCI were discarded"):
        line.close()
    assert line.lost == 10 and line.result.sci_bytes == 20
