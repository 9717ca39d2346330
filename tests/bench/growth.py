"""Growth of the cost of a run with the number of slaves on the bus and with the length of the run.

    N slaves on one bus, one of them addressed --> CPU seconds per simulated second, events per byte, memory
    imu_hil for 1 s, 10 s, 60 s (long: 600 s, 3600 s) --> the same

A wire has up to 62 parties, because the set of parties that pull it is a bit mask in a C integer; the controller is
one of them. A scene with more, such as 100 slaves, is rejected, and its row has the error message.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

from periph_sim import form
from periph_sim.core.wire import TooManyParties
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from periph_sim.scene.scene import Scene

from .child import TIMING, in_form
from .timed import peak_mib, timed

Row = dict[str, Any]

SLAVES = (1, 3, 10, 30, 61, 100)
LENGTHS = ("1", "10", "60")
LONG = (*LENGTHS, "600", "3600")
FIRST = 0x08  # the first address that is free for devices
REGISTERS = [{"name": "DATA", "at": 0, "reset": 0x5A}]


def with_slaves(number: int) -> Case:
    """Return a case with this number of register devices, the first of which is read by the controller."""
    devices = {f"d{n}": {"model": "registers", "address": FIRST + n, "register": REGISTERS} for n in range(number)}
    asks = {"period": "5 ms", "request": [{"address": FIRST, "pointer": 0, "count": 8}]}
    return Case.model_validate({"name": "growth", "unit": {}, "device": devices, "controller": asks, "duration": "1 s"})


def rows(forms: Sequence[str], long: bool) -> Iterator[Row]:
    for number in SLAVES:
        for which in forms:
            yield in_form(which, "growth", "slaves", number)
    for seconds in LONG if long else LENGTHS:
        yield in_form(forms[-1], "growth", "length", seconds)


def slaves(number: int) -> Row:
    row = {"slaves": number, "form": form.running}
    try:
        return row | measured(with_slaves(number), "1" if form.running == form.COMPILED else "0.2")
    except TooManyParties as refused:
        return row | {"refused": str(refused)}


def length(seconds: str) -> Row:
    return {"seconds": int(seconds), "form": form.running} | measured(load(TIMING / "imu_hil.toml"), seconds)


def measured(case: Case, seconds: str) -> Row:
    """Return the figures of one run. The process makes no other run, so its memory is that of this run."""
    scene = Scene(case)
    result, time = timed(lambda: scene.run(Fraction(seconds)))
    return {
        "cpu_s_per_s": time.cpu / float(Fraction(seconds)),
        "bytes_per_s": result.wire_bytes / time.cpu,
        "events_per_byte": result.events / result.wire_bytes,
        "process_mib": peak_mib(),
    }


def line(row: Row) -> str:
    what = f"{row['slaves']} slaves" if "slaves" in row else f"{row['seconds']} s of imu_hil"
    if "refused" in row:
        return f"{what:18} {row['form']:12} refused: {row['refused']}"
    return (
        f"{what:18} {row['form']:12} {row['cpu_s_per_s']:8.4f} s/s {row['bytes_per_s']:10,.0f} bytes/s "
        f"{row['events_per_byte']:6.1f} events/byte {row['process_mib']:6.1f} MiB"
    )
