"""The shipped measures: each has a name, and is defined by a sentence in the language of budgets (`timing/language`).

    name --> Sentence: its text, its cost, how far back it looks, and phrases for its verdict

Parameters of a sentence are in braces; `factory` fills them in from the words of a budget. Six measures are classes
instead, because no sentence can express them:

    Margin       depends on the parties that pull the wires and on the module's own delay, which no record contains
    Race         reconstructs the polls that were skipped, and needs all records of a register to do so
    LostFlags    depends on which flags firmware intends to clear at a place; this is known only at the end of the run
    Reply        compares a reply with the characters that a case expects, and quotes the characters that came
    Unsolicited  quotes the characters that no reply of a case expects
    WatchedWire  gets the expected time of an edge from a watcher, which may be the user's own
"""

from __future__ import annotations

from msgspec import Struct


class Sentence(Struct, frozen=True):
    """A named measure.

    about: a description for the documentation; "" if the name of the measure needs none.
    cost: the number of records that the measure handles when timing/imu_hil_published.toml runs for 0.1 s (5 rounds).
    looks_back: the range of past records on which the next value can depend; one of LOOKS_BACK. If `timing/derived`
        makes records for the measure, the range includes the records from which these records are made.
    asked: a noun in the plural for the events of the clause `for each`, at which a value should be measured.
    nothing: a phrase that says why nothing was measured; None if the measure finds the reason itself.
    unproven: for a clause `given`, a phrase that says why nothing is proven if the clause's event did not happen. If it
        is "", the verdict names the event.
    cut_off: for a clause `unfinished` or a pair, a phrase that says what was not over when the run ended.
    unknown: for each clause `unless`, a pair (noun, reason). If the event of the clause happened, the budget is not
        judged, with a reason such as "3 reads may carry other frames" from ("read", "may carry other frames").
    """

    text: str
    about: str = ""
    looks_back: str = "this occurrence"
    cost: int = 0
    asked: str = ""
    nothing: str | None = ""
    unproven: str = ""
    cut_off: str = ""
    unknown: tuple[tuple[str, str], ...] = ()


UNNAMED = Sentence("", nothing=None)
READS = "reads asked"
ROUNDS = "rounds due"
OTHER_FRAMES = "may carry frames that were not compared with them"

MEASURES = {
    "response": Sentence(
        "from record transfer acknowledge to record transfer answer, for each record transfer read",
        "From the SCL fall that ends the ACK slot of a read address to the SCL rise of the first data bit.",
        asked=READS,
        cost=45,
    ),
    "stretch": Sentence(
        "value of record transfer stretch, for each record transfer phase, unfinished record transfer held",
        "Longest time SCL was held low after the master had released it, per acknowledged phase, by any party.",
        asked="addressed phases asked",
        cut_off="SCL was still held low when the run ended",
        cost=60,
    ),
    "round": Sentence(
        "from record round begin to record round end, for each record round due",
        "From the start of a round to its last STOP. If the controller itself begins late, this delay does not count.",
        "this round",
        asked=ROUNDS,
        nothing="no round was completed",
        cost=15,
    ),
    "missed rounds": Sentence(
        "count of record round missed, for each record round due, measured at record round due, given record round due",
        "Rounds that did not begin while they were due, or that lack a request.",
        "the round before",
        asked=ROUNDS,
        unproven="no round was due",
        cost=5,
    ),
    "nacked rounds": Sentence(
        "count of record round refused, for each record round due, measured at record round begin, "
        "given record round begin",
        "Rounds with at least one request whose address was not acknowledged.",
        "this round",
        asked=ROUNDS,
        unproven="no round was completed",
        cost=10,
    ),
    "nacked": Sentence(
        "count of record transfer refused",
        "Transfers whose address was not acknowledged, polls included.",
        "this transfer",
    ),
    "wrong bytes": Sentence(
        "sum of record data wrong bytes, for each record data bytes asked, measured at record data bytes compared, "
        "unless record data zeros, unless record data unknown bytes",
        "Bytes read that differ from `expect` of the request, or from the values of host frames.",
        "the whole run",
        asked="bytes asked",
        unknown=(
            ("byte", "read as 0 from chips that never showed a host frame's values"),
            ("byte", "may be of frames that were not compared with them"),
        ),
        cost=42,
    ),
    "age": Sentence(
        "value of record data age{of}, for each record data chip read{of}, unless record data unknown age{of}",
        "From the end of the host frame whose values a read carries to the read's START.",
        "the whole run",
        asked=READS,
        unknown=(("read", OTHER_FRAMES),),
        cost=45,
    ),
    "model age": Sentence(
        "value of record data model age{of}, for each record data chip read{of}, given record data model run",
        "From the end of the last host frame before the models began to each read of the values that they computed.",
        "the whole run",
        asked=READS,
        nothing="no chip was read after a host frame had come",
        unproven="no span 'model' was over that began after a host frame had come",
        cost=35,
    ),
    "fifo high-water": Sentence(
        "value of record receiver words, for each record receiver character, measured at record receiver received",
        "Most words that ever waited in the SCI receive FIFO.",
        asked="characters on RX",
        cost=240,
    ),
    "overruns": Sentence(
        "count of record receiver lost, for each record receiver character, measured at record receiver received",
        "Characters lost in the SCI: FIFO overflow (RXFFOVF) or SCIRXBUF overrun (OE), counted as they happen.",
        asked="characters on RX",
        cost=120,
    ),
    "stuck": Sentence("count of record bus stuck", "Times a line of the bus was held low longer than `stuck_after`."),
}

# PHRASES has the measures that have parameters or depend on the scene. The keys are the first words of some forms in
# the language of budgets (`language.FORMS`), and the names "span", "overflows" and "first access".
PHRASES = {
    "span": Sentence(
        "from span any:{quoted} begin to span any:{quoted} end, last, same unit",
        "Time from the start of a named stretch of firmware to its end, service routines in between included.",
        nothing="there was no span {name!r}",
        cut_off="span {name!r} still lasted when the run ended",
        cost=30,
    ),
    "period": Sentence(
        "from {event} to {event}, in order",
        looks_back="the occurrence before",
        nothing=None,
        cut_off="{event!r} did not come again before the run ended",
    ),
    "overflows": Sentence("count of note overflow", nothing=None),
    "cpu": Sentence("share of {time} in cpu busy of {cpu}", looks_back="the whole run"),
    "bus": Sentence("share of {time} in bus busy", looks_back="the whole run"),
    "SCL": Sentence(
        "value of record transfer held alone of {i2c}, unfinished record transfer unfinished of {i2c}",
        looks_back="this transfer",
        cut_off="a transfer was not over when the run ended",
    ),
    "slack": Sentence(
        "from record round end to record round next, for each record round due",
        looks_back="this round",
        asked=ROUNDS,
        nothing="no round was completed",
        cost=15,
    ),
    "gap": Sentence(
        "from last bus STOP of round to first bus START of round",
        looks_back="the round before",
        nothing=None,
        cost=45,
    ),
    "reaction": Sentence(
        "from flag {i2c}:I2C-A.I2CSTR.SDIR rise or flag {i2c}:I2C-A.I2CSTR.XRDY rise to access W {i2c}:I2C-A.I2CDXR, "
        "last, same transfer",
        looks_back="this transfer",
        nothing=None,
        cost=391,
    ),
    "busy": Sentence(
        "from record transfer write end of {address} to bus address {address} ACK",
        looks_back="this transfer",
        nothing="no write to {address} was over before its address was acknowledged again",
        cut_off="{address} was not acknowledged again before the run ended",
    ),
    "interrupt": Sentence(
        "from flag {asked} rise to interrupt {vector} enter, last",
        nothing=None,
        cost=20,
    ),
    "first access": Sentence(
        "from flag {asked} rise to first access by {unit} of interrupt {vector}, last",
        nothing=None,
        cut_off="'flag {asked} rise' still waited for an access of its routine when the run ended",
    ),
    "value": Sentence(
        "value of record data value error{at}{of}, for each record data sample{of}, "
        "unless record data unknown error{of}",
        asked=READS,
        nothing="no sample of {chips} was read after a host frame had come",
        unknown=(("read", "may fit frames that were not compared with them"),),
        looks_back="the whole run",
        cost=30,
    ),
}
