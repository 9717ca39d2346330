"""The page of a live session: what is served, to whom, and how it looks in a browser."""

from __future__ import annotations

import json
import socket
import time
from collections.abc import Iterator
from http.client import HTTPConnection

import pytest

from periph_sim.outside.live.view.browser import Browser
from periph_sim.outside.live.view.status import Board, StatusSnapshot
from tests.outside.live.view.imu import FRAME, Imu
from tests.outside.sessions import refuses


@pytest.fixture(scope="module")
def snapshot() -> StatusSnapshot:
    imu = Imu(budget=[{"name": "too much", "measure": "round", "max": "1 us"}])
    imu.line.write(FRAME)
    for _ in range(3):
        imu.passes("20 ms")
    imu.status.say("client 1 <b>came</b>")
    return imu.status.snapshot()


@pytest.fixture
def board() -> Board:
    return Board()


@pytest.fixture
def served(board: Board) -> Iterator[Browser]:
    one = Browser(board, 0)
    yield one
    board.close()
    one.close()


def asked(served: Browser, path: str, host: str = "") -> tuple[int, bytes]:
    port = int(served.url.rstrip("/").rpartition(":")[2])
    connection = HTTPConnection("127.0.0.1", port, timeout=30)
    connection.request("GET", path, headers={"Host": host or f"127.0.0.1:{port}"})
    came = connection.getresponse()
    return came.status, came.read()


def test_only_the_page_is_served_and_only_to_this_computer(served: Browser) -> None:
    status, page = asked(served, "/")
    assert status == 200 and b"EventSource" in page
    assert asked(served, "/etc/passwd")[0] == 404
    assert asked(served, "/", "localhost:80")[0] == asked(served, "/", "localhost")[0] == 200
    for host in ("evil.example", "evil.example:80", "127.0.0.1.evil.example"):
        assert asked(served, "/events", host)[0] == 403


def test_headers_of_the_answers(board: Board, served: Browser, snapshot: StatusSnapshot) -> None:
    connection = HTTPConnection(*served.url.removeprefix("http://").rstrip("/").split(":"), timeout=30)  # type: ignore[arg-type]
    connection.request("GET", "/")
    page = connection.getresponse()
    data = page.read()
    headers = {name: value for name, value in page.getheaders() if name != "Date"}
    assert headers == {
        "Server": "periph-sim ",
        "Content-Type": "text/html; charset=utf-8",
        "Content-Length": str(len(data)),
        "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
        "connect-src 'self'; img-src data:",
    }
    board.put(snapshot)
    board.close()
    connection.request("GET", "/events")
    events = connection.getresponse()
    assert [events.getheader(name) for name in ("Content-Type", "Cache-Control")] == ["text/event-stream", "no-store"]
    assert events.read() == f"data: {json.dumps(snapshot)}\n\n".encode()


def test_at_another_address_any_host_name_is_accepted(board: Board) -> None:
    one = Browser(board, 0, "0.0.0.0")
    assert asked(one, "/", "bench.example")[0] == 200
    board.close()
    one.close()


def test_events_are_the_snapshots_and_end_with_the_session(
    board: Board, served: Browser, snapshot: StatusSnapshot
) -> None:
    board.put(snapshot)
    board.put({**snapshot, "over": True})
    board.close()
    status, data = asked(served, "/events")
    events = [
        json.loads(line.removeprefix("data: ")) for line in data.decode().splitlines() if line.startswith("data:")
    ]
    assert status == 200 and events == [{**snapshot, "over": True}]


def test_clients_that_disconnect_or_send_garbage_do_not_affect_others(
    board: Board, served: Browser, snapshot: StatusSnapshot
) -> None:
    address = ("127.0.0.1", int(served.url.rstrip("/").rpartition(":")[2]))
    for data in (b"", b"\x00\xff\r\n\r\n", b"GET /events HTTP/1.0\r\nHost: localhost\r\n\r\n"):
        with socket.create_connection(address) as client:
            client.sendall(data)
    board.put(snapshot)
    assert asked(served, "/")[0] == 200


def test_closing_takes_a_fraction_of_a_second(board: Board) -> None:
    times = []
    for _ in range(5):  # the fastest is used, since other programs may run
        one = Browser(board, 0)
        begin = time.monotonic()
        one.close()
        times.append(time.monotonic() - begin)
    assert min(times) < 0.5


def test_a_port_that_is_taken_is_refused(served: Browser, board: Board) -> None:
    port = int(served.url.rstrip("/").rpartition(":")[2])
    refuses(rf"port {port} of 127.0.0.1: Address already in use; give another one", Browser, board, port)


@pytest.mark.long  # a browser
def test_the_page_shows_all_parts_of_a_snapshot(
    board: Board, served: Browser, snapshot: StatusSnapshot, browser
) -> None:
    wrong: list[str] = []
    for width, scheme in ((1400, "dark"), (400, "light")):
        page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)
        page.on("console", lambda message: wrong.append(message.text))
        page.on("pageerror", lambda error: wrong.append(str(error)))
        board.put(snapshot)
        page.goto(served.url)
        page.wait_for_selector("#wave path")
        text = page.inner_text("body")
        for part in ("live, a budget is broken", "round 3, from", "magnetometer", "SCL", "too much", "99 % within"):
            assert part in text
        assert page.locator("#said li").inner_text() == "client 1 <b>came</b>"
        assert page.locator("#wave path").count() == 3
        assert page.evaluate("document.documentElement.scrollWidth") == width
        board.put({**snapshot, "over": True, "budgets": []})
        page.locator("#state", has_text="ended").wait_for()
        page.close()
    assert not wrong
