"""Function calls of a short interpreted run, for the guided tour of CONTRIBUTING.md: `python -m tests.docs.tour`.

Prints two lists of pairs (file, function) as JSON: of 2 ms of the case `responder`, and of a command that judges it.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
from collections.abc import Callable
from types import FrameType

from tests.docs.pages import ROOT

LENGTH = "0.002"  # seconds: the address, a pointer and the first bytes of a reply


def calls_of(run: Callable[[], object]) -> list[tuple[str, str]]:
    """Return the file and the qualified name of each function of the package that is called, in order."""
    calls: list[tuple[str, str]] = []

    def called(frame: FrameType, event: str, argument: object) -> None:
        code = frame.f_code
        if event == "call" and code.co_filename.startswith(f"{ROOT}/periph_sim/"):
            calls.append((code.co_filename.removeprefix(f"{ROOT}/"), code.co_qualname))

    sys.setprofile(called)
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            run()
    finally:
        sys.setprofile(None)
    return calls


def main() -> None:
    from periph_sim import cli, load
    from periph_sim.scene.scene import Scene

    case = ROOT / "timing" / "responder.toml"
    scene = Scene(load(case, ["disable=['bits']"]))
    run = calls_of(lambda: scene.advance(scene.start + scene.timebase.per_second // 500))
    command = ["run", str(case), "--seconds", LENGTH]
    print(json.dumps([run, calls_of(lambda: cli.cli.main(command, standalone_mode=False))]))


if __name__ == "__main__":
    os.environ["PERIPH_SIM_FORM"] = "interpreted"  # calls of compiled functions are not observed
    main()
