"""Whatever happens to the bytes of a capture, reading it gives a sound Capture or one sentence."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from periph_sim import formats
from tests.formats.test_saleae_bin import version_0, version_1
from tests.formats.test_saleae_csv import LOGIC2
from tests.formats.test_sigrok_sr import V1
from tests.formats.test_vcd import SIGROK
from tests.formats.writers import metadata, sr_bytes, zip_bytes

GOOD = {
    "v2.sr": sr_bytes(["SCL", "SDA"], "4 MHz", b"\3\3\1\0", b"\2\2\3"),
    "v1.sr": zip_bytes({"logic-1": b"\3\2\2\3", "metadata": V1, "version": b"1"}),
    "packed.sr": zip_bytes(
        {"version": b"2", "metadata": metadata(["a"], "1 MHz"), "logic-1-1": bytes(99)}, zipfile.ZIP_DEFLATED
    ),
    "sigrok.vcd": SIGROK.encode(),
    "vector.vcd": b"$timescale 1ps $end $var reg 4 ! a[3:0] $end $var real 64 r v $end\n#0 b1xz0 ! r1.5 r\n#9 b0 !\n",
    "logic2.csv": LOGIC2.encode(),
    "iso.csv": b"Time [s],a\n2022-06-24T23:59:59.999999990+02:00,0\n2022-06-25T00:00:00.000000010+02:00,1\n",
    "samples.csv": b"; Channels (2/8): SCL, SDA\n; Samplerate: 4 MHz\nSCL,SDA\n1,1\n1,0\n0,0\n",
    "changes.csv": b"; Channels (1/8): a\n; Samplerate: 500 kHz\nmicroseconds,logic\n2,1\n236,0\n",
    "digital_0.bin": version_0(1, 0.0, 1e-6, [120e-9, 200e-9]),
    "digital_1.bin": version_1((1, 1e6, 0.0, 9e-6, [4e-6]), (1, 1e6, 20e-6, 29e-6, [25e-6])),
}

DAMAGE = st.tuples(st.integers(0, 2000), st.integers(0, 8), st.binary(max_size=8))


@pytest.mark.parametrize("name", GOOD)
@given(damage=st.lists(DAMAGE, min_size=1, max_size=3), rate=st.sampled_from([None, 1_000_000, 24_000_000]))
@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_damaged_bytes(tmp_path, name: str, damage: list[tuple[int, int, bytes]], rate: int | None):
    content = GOOD[name]
    for place, removed, added in damage:
        place %= len(content) + 1
        content = content[:place] + added + content[place + removed :]
    path = tmp_path / name
    path.write_bytes(content)
    try:
        capture = formats.read(path, None if rate is None else formats.rate_of(str(rate)))
    except formats.BadCapture as error:
        message = str(error)
        assert message.startswith(str(path)) and "\n" not in message
        assert ": found " in message and ", expected " in message and "; " in message
        return
    assert capture.length >= 1
    for channel in capture.channels:
        assert channel.initial in (0, 1) and len(channel.edges) == len(channel.levels)
        assert (np.diff(channel.edges, prepend=0) > 0).all()
        assert not len(channel.edges) or channel.edges[-1] < capture.length
        assert (np.diff(channel.levels.astype(int), prepend=channel.initial) != 0).all()
        assert all(0 <= hole.begin < hole.end <= capture.length for hole in channel.unknown)
