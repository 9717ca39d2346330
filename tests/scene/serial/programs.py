"""Firmware for tests of serial lines, and scenes that run it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from periph_sim import Dsp, Scene
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.firmware import start_sci
from tests.scene.small import case, given

Program = Callable[[Dsp], None]


def scene(
    programs: dict[str, Program],
    seen: list[Record] | None = None,
    kinds: Iterable[Kind] = Kind,
    subscribe: Callable[[Recorder, Timebase], None] | None = None,
    **tables: Any,
) -> Scene:
    """Return a scene of these programs by unit. `seen` receives the records of `kinds`, unless `subscribe` is given."""
    if seen is not None and subscribe is None:
        subscribe = lambda recorder, timebase: recorder.subscribe(list(kinds), seen.append)  # noqa: E731
    return Scene(case(**tables), subscribe, given(**programs))


def send(dsp: Dsp, module: str, data: bytes) -> None:
    """Write bytes to an SCI with its FIFO enabled, as fast as it accepts them."""
    sci = dsp.module(module)
    for byte in data:
        dsp.spin(lambda: sci.SCIFFTX.TXFFST < 16)
        sci.SCITXBUF.all = byte


def sender(module: str, data: bytes, **started: int) -> Program:
    """Return firmware that sends some bytes."""

    def main(dsp: Dsp) -> None:
        start_sci(dsp, module, **started)
        send(dsp, module, data)

    return main


def receive(dsp: Dsp, module: str, words: list[int]) -> None:
    """Store every word of SCIRXBUF of an SCI that was started."""
    sci = dsp.module(module)
    while True:
        dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
        words.append(sci.SCIRXBUF.all)


def receiver(module: str, words: list[int], **started: int) -> Program:
    """Return firmware that stores every word of SCIRXBUF."""

    def main(dsp: Dsp) -> None:
        start_sci(dsp, module, **started)
        receive(dsp, module, words)

    return main


def replier(module: str, replies: dict[bytes, bytes], delay: int = 0, **started: int) -> Program:
    """Return firmware that sends the reply that belongs to what it has received. delay: cycles before each reply."""

    def main(dsp: Dsp) -> None:
        sci = start_sci(dsp, module, **started)
        got = b""
        while True:
            dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
            got += bytes([sci.SCIRXBUF.all & 0xFF])
            if got in replies:
                dsp.compute(delay)
                send(dsp, module, replies[got])
                got = b""

    return main
