"""`periph-sim host-unit` sends frames to a case, and refuses wrong arguments."""

from __future__ import annotations

import signal
import sys
from pathlib import Path

import pytest

from tests.imu.test_host_unit import flight  # noqa: F401
from tests.interfaces.commands.conftest import Run
from tests.interfaces.commands.test_serve import Serve, serve  # noqa: F401
from tests.outside.live.echo import written

pytest.importorskip("serial", reason="pyserial is not installed: the extra live has it")


def test_frames_of_a_flight_are_sent_and_wrong_arguments_refused(periph_sim: Run, flight: Path, tmp_path: Path) -> None:  # noqa: F811
    url = f"f28335://{written(tmp_path)}?pace=0"
    came = periph_sim("host-unit", url, "--flight", str(flight), "--frames", "3", "--host-encoding", "byte_order=big")
    assert came.status == 0 and came.out.startswith(f"3 frames, 36 bytes sent to {url}, ")
    for arguments, sentence in (
        ((url,), "give either --flight or --udp"),
        ((url, "--udp", "x"), "--udp 'x': expected a port up to 65535"),
        (("/dev/none", "--flight", str(flight)), "/dev/none"),
        (("f28335://none.toml", "--flight", str(flight)), "none.toml: cannot be read"),
        (("nosuch://x", "--flight", str(flight)), "nosuch"),
        ((url, "--flight", "none.csv"), "none.csv"),
        ((url, "--flight", str(flight), "--host-encoding", "phi"), "--host-encoding 'phi': expected key=value"),
        ((url, "--flight", str(flight), "--host-encoding", "phy=1 deg"), "there is no|no setting 'phy'"),
        ((url, "--flight", str(flight), "--period", "0 s"), "--period 0 s: expected more than 0"),
    ):
        refused = periph_sim("host-unit", *arguments)
        said = refused.err.replace("\n", " ")
        assert refused.status == 2 and any(part in said for part in sentence.split("|")), said


def test_frames_are_sent_to_a_port_without_a_write_timeout(
    periph_sim: Run,
    flight: Path,  # noqa: F811
    tmp_path: Path,
    serve: Serve,  # noqa: F811
) -> None:
    served = serve(str(written(tmp_path)), "--rfc2217", "0")
    assert served.stdout is not None
    url = served.stdout.readline().strip()
    came = periph_sim("host-unit", url, "--flight", str(flight), "--frames", "2")
    served.send_signal(signal.SIGINT)
    served.communicate(timeout=60)
    assert came.status == 0 and came.out.startswith(f"2 frames, 24 bytes sent to {url}, "), came.err


def test_without_pyserial_the_error_names_the_package(periph_sim: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "serial", None)
    came = periph_sim("host-unit", "/dev/none", "--udp", "0")
    assert (came.status, came.err) == (2, "Error: the host unit needs pyserial: pip install 'periph-sim[live]'\n")
