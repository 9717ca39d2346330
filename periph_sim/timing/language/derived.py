"""Things that are derived from a run's other records: the names that `record` events have for them.

    "record round missed" --> Kind.ROUND, "missed"; needs rounds in the scene
    "value of record data age" --> its value is a time, and belongs to a read

What each thing is, and its tick and value, is at the head of the file in `timing/derived` that makes it, or of
`scene/sci_monitor.py`.
"""

from __future__ import annotations

from typing import NamedTuple


class Thing(NamedTuple):
    """needs: what the scene must have, as of a `Measure`. unit: of its value. by_read: it is of one phase."""

    needs: str
    unit: str = "value"
    by_read: bool = False


ON_BUS = Thing("I2C-A")
IN_ROUND = Thing("rounds")
AT_SCI = Thing("SCI")
OF_HOST = Thing("host")
BYTES = Thing("rounds", "bytes")
AGE = Thing("host", "time", by_read=True)
ERROR = Thing("host", "LSB", by_read=True)

RECORDS: dict[str, dict[str, Thing]] = {
    "transfer": {
        **dict.fromkeys(("phase", "read", "acknowledge", "answer", "refused"), ON_BUS),
        "stretch": Thing("I2C-A", "time", by_read=True),
        "held": Thing("I2C-A", "time"),
    },
    "round": dict.fromkeys(("due", "missed", "begin", "end", "next", "refused"), IN_ROUND),
    "receiver": {**dict.fromkeys(("character", "received", "lost"), AT_SCI), "words": Thing("SCI", "words")},
    "data": {
        **dict.fromkeys(("bytes asked", "bytes compared", "wrong bytes", "zeros", "unknown bytes"), BYTES),
        **dict.fromkeys(("chip read", "unknown age", "model run", "sample", "unknown error"), OF_HOST),
        **dict.fromkeys(("age", "model age"), AGE),
        **dict.fromkeys(("value error", "value error at frame"), ERROR),
    },
    "bus": {"stuck": ON_BUS},
}
