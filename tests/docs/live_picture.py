"""The picture of a live session on docs/live.md: a case is served, a host sends frames, a browser takes the picture.

    periph-sim serve CASE --pty --browser 0     periph-sim host-unit PTY --flight FLIGHT     -> pictures/live.png

The figures in the picture differ each time, because the session is live. So the picture contains the digest of the
page's source: it is out of date if that has changed.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from hashlib import sha256
from pathlib import Path

from tests.docs.pages import FILE, ROOT
from tests.docs.photographs import opened, with_digest

PAGE = ROOT / "docs" / "live.md"
PICTURE = ROOT / "docs" / "pictures" / "live.png"
SHOWN = ROOT / "periph_sim" / "outside" / "live" / "view" / "page.html"
CASE = ROOT / "timing" / "imu_hil.toml"
WATCHED = 8000  # milliseconds: the motion of the flight is fastest then
WIDTH = 1200


def digest_now() -> str:
    return sha256(SHOWN.read_bytes()).hexdigest()


def taken() -> bytes:
    """Return the page as PNG while the session is live."""
    flight = dict(FILE.findall(PAGE.read_text(encoding="utf-8")))["flight.csv"]
    command = [sys.executable, "-m", "periph_sim"]
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "flight.csv").write_text(flight)
        serves = [*command, "serve", str(CASE), "--pty", f"{folder}/dsp", "--browser", "0"]
        served = subprocess.Popen(serves, stdout=subprocess.PIPE, text=True)
        try:
            assert served.stdout is not None
            served.stdout.readline()
            url = served.stdout.readline().strip()
            assert re.fullmatch(r"http://127\.0\.0\.1:\d+/", url), url
            sends = [*command, "host-unit", f"{folder}/dsp", "--flight", f"{folder}/flight.csv"]
            with subprocess.Popen(sends, stdout=subprocess.DEVNULL) as sender:
                try:
                    with opened(url, WIDTH) as page:
                        page.wait_for_timeout(WATCHED)
                        return with_digest(page.screenshot(full_page=True), digest_now())
                finally:
                    sender.terminate()
        finally:
            served.terminate()
            served.communicate()
