"""Each lint over hand-made records: a fault, and each of the conditions without which it is not a fault.

A line is a record: cycle, then `R` or `W` register value place [field], `flag` name value, or `irq` vector value. `<n`
makes the n-th line its cause.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import pytest

from periph_sim.core.records import Kind
from periph_sim.records.lint import Options, all_lints, lint, text
from periph_sim.records.run import Run
from tests.records.scenes import CYCLE, by_hand

END = 1_000_000  # cycles


def drawn(text: str) -> Run:
    return by_hand(*_rows(text), end=END)


def _rows(text: str) -> Iterator[tuple[Any, ...]]:
    before = 0
    for line in filter(None, (line.strip() for line in text.splitlines())):
        cycle, kind, *rest = line.split()
        assert int(cycle) >= before, f"{line}: the lines are not in order of time"
        before = int(cycle)
        cause = int(rest.pop()[1:]) if rest[-1].startswith("<") else 0
        if kind in ("R", "W"):
            register, value, place, *field = rest
            register = register if "." in register else f"I2C-A.{register}"
            yield int(cycle), Kind.ACCESS, "dsp", f"{kind} {register}", int(value, 0), place, cause, *field
        elif kind == "flag":
            yield int(cycle), Kind.FLAG, "dsp.I2C-A", rest[0], int(rest[1], 0), "", cause
        else:
            yield int(cycle), Kind.IRQ, "dsp", rest[0], int(rest[1], 0), "", cause


def found(name: str, text: str, options: Options | None = None) -> list[tuple[int, str]]:
    """(cycle, text of the finding) of each access at fault."""
    run = drawn(text)
    return [
        (int(run.table.tick[row]) // CYCLE, fault.text)
        for fault in all_lints()[name].faults(run, options or Options())
        for row in fault.rows.tolist()
    ]


def cycles(name: str, text: str) -> list[int]:
    return [cycle for cycle, _ in found(name, text)]


def changed(text: str, old: str, new: str) -> str:
    assert text.count(old) == 1, old
    return text.replace(old, new)


ON = "1 flag I2CMDR.IRS 1\n"

# Writes ---------------------------------------------------------------------------------------------------------

ADDRESS = f"{ON}2 flag I2COAR.OAR 0x50\n5 flag I2CSTR.BB 1\n10 W I2COAR 0x22 f:1\n10 flag I2COAR.OAR 0x22 <4"


@pytest.mark.parametrize(
    ("old", "new", "at"),
    [
        ("10 W", "10 W", [10]),
        ("I2CSTR.BB 1", "I2CSTR.BB 0", []),
        ("I2CMDR.IRS 1", "I2CMDR.IRS 0", []),
        ("0x22 f:1", "0x50 f:1", []),
        ("0x22 f:1", "0xFC50 f:1", []),  # beyond the field
        ("10 W I2COAR", "10 R I2COAR", []),
        ("10 W I2COAR", "10 W I2CSAR", []),
    ],
)
def test_a_change_of_the_own_address_during_a_transfer(old: str, new: str, at: list[int]):
    assert cycles("own-address-in-transfer", changed(ADDRESS, old, new)) == at


PRESCALER = f"{ON}2 flag I2CPSC.IPSC 14\n10 W I2CPSC 9 f:1\n10 flag I2CPSC.IPSC 9 <3"


@pytest.mark.parametrize(
    ("old", "new", "at"),
    [
        ("10 W", "10 W", [10]),
        ("I2CMDR.IRS 1", "I2CMDR.IRS 0", []),
        ("I2CPSC 9", "I2CPSC 14", []),
        ("I2CPSC 9", "I2CPSC 0xFF0E", []),
        ("10 W I2CPSC", "10 R I2CPSC", []),
        ("10 W I2CPSC", "10 W I2CCNT", []),
    ],
)
def test_a_change_of_the_prescaler_while_the_module_is_enabled(old: str, new: str, at: list[int]):
    assert cycles("prescaler-while-enabled", changed(PRESCALER, old, new)) == at


READ_ONLY = "5 flag I2CSTR.BB 1\n10 R I2CSTR 0x1410 f:1 SCD\n11 flag I2CSTR.BB 0\n12 W I2CSTR 0x1430 f:1 SCD"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (READ_ONLY, []),  # the value that was read is written back, although BB has been cleared since
        ("10 W I2CSTR 0x1400 f:1", [(10, "writes I2C-A.I2CSTR.BB, which is read-only")]),  # XSMT is 1
        ("5 flag I2CSTR.BB 1\n10 W I2CSTR 0x1400 f:1", []),
        ("5 flag I2CSTR.BB 1\n10 W I2CSTR 0 f:1", []),
        ("10 R I2CSTR 0x1400 f:1", []),
        (
            changed(READ_ONLY, "0x1430", "0x1630"),
            [(12, "writes I2C-A.I2CSTR.AAS, which is read-only")],
        ),
        ("10 W SCI-A.SCIFFRX 0x0300 f:1", [(10, "writes SCI-A.SCIFFRX.RXFFST, which is read-only")]),
        (
            "10 W I2CSTR 0x1200 f:1\n20 W I2CSTR 0x1000 f:2",
            [
                *[(cycle, "writes I2C-A.I2CSTR.BB, which is read-only") for cycle in (10, 20)],
                (10, "writes I2C-A.I2CSTR.AAS, which is read-only"),
            ],
        ),
    ],
)
def test_a_read_only_field_written_with_another_value(text: str, said: list[tuple[int, str]]):
    assert found("read-only", text) == said


TRX = "writes TRX as slave, whose direction the address tells: without effect"
COUNT = "writes I2CCNT as slave: without effect on what it receives, and by default on what it sends"


def lost(name: str) -> str:
    return f"writes {name} with IRS = 0: lost, as the module is held in reset"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("10 W I2CCNT 6 f:1", [(10, COUNT)]),
        ("10 R I2CCNT 6 f:1", []),
        ("5 flag I2CMDR.MST 1\n10 W I2CCNT 6 f:1", []),
        ("10 W I2CCNT 6 f:1\n20 flag I2CMDR.MST 1", []),
        (
            "10 W I2CCNT 6 f:1\n20 W I2CCNT 5 f:2\n30 flag I2CMDR.MST 1",
            [(10, COUNT)],
        ),  # the second write is for the master mode
        ("5 flag I2CMDR.MST 1\n7 flag I2CMDR.MST 0\n10 W I2CCNT 6 f:1\n20 flag I2CMDR.MST 0", [(10, COUNT)]),
        (f"{ON}10 W I2CMDR 0x0220 f:1 TRX", [(10, TRX)]),
        (f"{ON}10 W I2CMDR 0x0020 f:1 TRX", [(10, TRX)]),  # writing 0 has no effect either
        (f"{ON}10 W I2CMDR 0x0220 f:1 IRS", []),
        (f"{ON}10 W I2CMDR 0x0220 f:1", []),
        (f"{ON}10 W I2CMDR 0x0620 f:1 TRX", []),  # MST
        (f"{ON}10 W I2CMDR 0x0228 f:1 TRX", []),  # FDF
        (f"{ON}5 flag I2CMDR.MST 1\n10 W I2CMDR 0x0220 f:1 TRX", []),
        (f"{ON}10 W I2CMDR 0x0220 f:1 TRX\n10 flag I2CMDR.TRX 1 <2\n20 flag I2CMDR.MST 1", []),
        (
            f"{ON}10 W I2CMDR 0x0220 f:1 TRX\n10 flag I2CMDR.TRX 1 <2\n15 flag I2CMDR.TRX 0\n20 flag I2CMDR.MST 1",
            [(10, TRX)],
        ),
        ("10 W I2CMDR 0x2000 f:1", [(10, lost("STT"))]),
        ("10 W I2CMDR 0x0800 f:1", [(10, lost("STP"))]),
        ("10 W I2CMDR 0x2800 f:1", [(10, lost("STT")), (10, lost("STP"))]),
        ("10 W I2CMDR 0x2020 f:1", []),  # with IRS
        (f"{ON}10 W I2CMDR 0x2000 f:1", []),
        ("10 R I2CMDR 0x2000 f:1", []),
    ],
)
def test_a_write_without_effect(text: str, said: list[tuple[int, str]]):
    assert found("without-effect", text) == said


MODE_OFF = f"{ON}2 flag I2CSTR.AAS 1\n3 flag I2CSTR.BB 1\n10 W I2CMDR 0 f:1\n10 flag I2CMDR.IRS 0 <4"


@pytest.mark.parametrize(
    ("old", "new", "at"),
    [
        ("10 W", "10 W", [10]),
        ("1 flag I2CMDR.IRS 1", "1 flag I2CMDR.IRS 0", []),
        ("I2CSTR.AAS 1", "I2CSTR.AAS 0", []),
        ("I2CSTR.AAS 1", "I2CMDR.MST 1", [10]),
        ("I2CSTR.BB 1", "I2CSTR.BB 0", []),
        ("I2CMDR 0 f:1", "I2CMDR 0x20 f:1", []),
        ("10 W I2CMDR", "10 R I2CMDR", []),
        ("10 W I2CMDR", "10 W I2CCNT", []),
    ],
)
def test_a_reset_of_the_module_during_a_transfer(old: str, new: str, at: list[int]):
    assert cycles("reset-in-transfer", changed(MODE_OFF, old, new)) == at


# The data registers ---------------------------------------------------------------------------------------------

OVERWRITTEN = f"""{ON}2 flag I2CSTR.AAS 1
    5 W I2CDXR 1 f:1
    5 flag I2CSTR.XRDY 0 <3
    10 W I2CDXR 2 f:2"""


@pytest.mark.parametrize(
    ("old", "new", "at"),
    [
        ("10 W", "10 W", [10]),
        ("1 flag I2CMDR.IRS 1", "1 flag I2CMDR.IRS 0", []),
        ("5 flag I2CSTR.XRDY 0 <3", "6 flag I2CSTR.SCD 0", []),  # XRDY has been 1 since reset
        ("2 flag I2CSTR.AAS 1", "2 flag I2CFFTX.I2CFFEN 1", []),
        ("10 W I2CDXR", "10 R I2CDXR", []),
        ("5 W I2CDXR", "5 W I2CCNT", []),
        ("10 W", "7 flag I2CSTR.XRDY 1\n8 flag I2CSTR.XRDY 0\n10 W", []),  # sent meanwhile
        ("10 W", "7 flag I2CSTR.AAS 0\n10 W", []),  # another transfer
        ("10 W", "7 flag I2CSTR.BB 1\n10 W", []),
        ("10 W", "7 flag I2CSTR.RRDY 1\n10 W", [10]),
        ("10 W I2CDXR 2 f:2", "10 W I2CDXR 2 f:2\n20 W I2CDXR 3 f:2", [10, 20]),
    ],
)
def test_a_byte_overwritten_before_it_was_sent(old: str, new: str, at: list[int]):
    assert cycles("transmit-register-overwritten", changed(OVERWRITTEN, old, new)) == at


EARLY = f"{ON}5 flag I2CSTR.RRDY 1\n10 R I2CDRR 7 f:1\n10 flag I2CSTR.RRDY 0 <3\n20 R I2CDRR 7 f:2"


@pytest.mark.parametrize(
    ("old", "new", "at"),
    [
        ("20 R", "20 R", [20]),
        ("20 R", "15 flag I2CSTR.RRDY 1\n20 R", []),
        ("1 flag I2CMDR.IRS 1", "1 flag I2CMDR.IRS 0", []),
        ("10 flag I2CSTR.RRDY 0 <3", "10 flag I2CSTR.RRDY 0", []),  # not cleared by the read: the byte is still there
        ("10 flag I2CSTR.RRDY 0 <3", "11 flag I2CSTR.RRDY 0 <3", []),
        ("20 R I2CDRR", "20 W I2CDRR", []),
        ("20 R I2CDRR", "20 R I2CCNT", []),
        ("20 R", "15 flag I2CFFRX.RXFFRST 1\n20 R", []),
        ("5 flag I2CSTR.RRDY 1", "5 flag I2CSTR.SCD 1", [10, 20]),  # no byte was ever received
    ],
)
def test_the_receive_register_read_without_a_byte(old: str, new: str, at: list[int]):
    text = changed(EARLY, old, new)
    assert cycles("receive-register-early", text) == at


def test_the_receive_register_read_before_any_byte_was_received():
    assert cycles("receive-register-early", f"{ON}10 R I2CDRR 0 f:1") == [10]


ONCE, TWICE = (f"I2C-A.I2CDRR is never read, though RRDY rose {times}" for times in ("1 time", "2 times"))
UNREAD = "5 flag I2CSTR.RRDY 1\n7 R I2CSTR 0 f:0\n10 R I2CSTR 8 f:1\n20 R I2CSTR 8 f:2"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (UNREAD, [(10, ONCE)]),
        (f"{UNREAD}\n30 flag I2CSTR.RRDY 0\n31 flag I2CSTR.RRDY 1", [(10, TWICE)]),
        (f"{UNREAD}\n30 R I2CDRR 1 f:3", []),
        (f"{UNREAD}\n30 W I2CDRR 1 f:3", [(10, ONCE)]),
        (changed(UNREAD, "RRDY 1", "RRDY 0"), []),
        (UNREAD.replace(" 8 ", " 0 "), [(7, ONCE)]),  # no read saw it
        ("5 flag I2CSTR.RRDY 1", []),  # no read of I2CSTR, so there is no place
    ],
)  # fmt: skip
def test_a_received_byte_that_is_never_read(text: str, said: list[tuple[int, str]]):
    assert found("receive-register-unread", text) == said


ALONE = f"{ON}5 R I2CSTR 0x0410 f:1\n10 W I2CDXR 1 f:2"
ON_XRDY = "loads I2CDXR as slave on XRDY alone: its last look at it showed SDIR = 0, so no master was reading yet"
WIPED = (
    "loads I2CDXR as slave with SDIR = 0 though a master reads: the firmware itself cleared SDIR in this transfer, "
    "by writing I2CSTR at {}"
)


@pytest.mark.parametrize(
    ("old", "new", "at"),
    [
        ("10 W", "10 W", [10]),
        ("1 flag I2CMDR.IRS 1", "1 flag I2CMDR.IRS 0", []),
        ("0x0410", "0x0400", []),  # XRDY was read as 0
        ("0x0410", "0x4410", []),  # SDIR was read as 1
        ("10 W", "7 flag I2CSTR.SDIR 1\n10 W", []),
        ("10 W", "7 flag I2CMDR.MST 1\n10 W", []),
        ("10 W", "7 flag I2CMDR.FDF 1\n10 W", []),
        ("10 W", "7 flag I2CFFTX.I2CFFEN 1\n10 W", []),
        ("10 W", "7 R I2CSTR 0x4410 f:1\n10 W", []),  # the last read is decisive
        ("1 f:2", "1 f:2\n20 W I2CMDR 0x0620 f:3", []),  # it becomes master
        ("1 f:2", "1 f:2\n20 W I2CMDR 0x0020 f:3\n30 W I2CMDR 0x0620 f:3", [10]),
        ("10 W", "7 R I2CSTR 0x4410 f:1 SCD\n10 W", [10]),  # not a read of XRDY
        ("10 W", "7 R I2CSTR 0x4410 f:1 SCD\n9 W I2CSTR 0x4420 f:1 SCD\n10 W", [10]),
        ("0x0410 f:1", "0x0410 f:1 XRDY", [10]),
        ("0x0410 f:1", "0x0410 f:1 BB", []),
        ("10 W", "7 W I2CDXR 1 f:1\n10 W", [7]),  # not read since
        ("5 R I2CSTR", "5 R I2CIER", []),  # never read
        ("5 R I2CSTR 0x0410 f:1\n10 W I2CDXR 1 f:2", "5 W I2CDXR 1 f:2\n10 R I2CSTR 0x0410 f:1", []),
        ("10 W I2CDXR", "10 R I2CDXR", []),
    ],
)
def test_a_byte_loaded_on_xrdy_alone(old: str, new: str, at: list[int]):
    assert found("xrdy-alone", changed(ALONE, old, new)) == [(cycle, ON_XRDY) for cycle in at]


CLEARED = f"""{ON}2 flag I2CSTR.AAS 1
    3 flag I2CSTR.SDIR 1
    4 W I2CSTR 0x4020 g:9
    4 flag I2CSTR.SDIR 0 <4
    5 R I2CSTR 0x0410 f:1
    10 W I2CDXR 1 f:2"""


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("10 W", "10 W", WIPED.format("g:9")),
        ("4 flag I2CSTR.SDIR 0 <4", "4 flag I2CSTR.SDIR 0", ON_XRDY),
        ("2 flag I2CSTR.AAS 1", "2 flag I2CSTR.SCD 1", ON_XRDY),
        ("5 R", "5 flag I2CSTR.AAS 0\n5 R", ON_XRDY),  # no longer addressed
        ("5 R", "5 flag I2CSTR.AAS 0\n5 flag I2CSTR.AAS 1\n5 R", ON_XRDY),  # addressed again after SDIR was cleared
        ("4 W I2CSTR", "4 W I2CMDR", ON_XRDY),
    ],
)
def test_a_byte_loaded_after_the_firmware_cleared_the_direction(old: str, new: str, said: str):
    assert found("xrdy-alone", changed(CLEARED, old, new)) == [(10, said)]


# Flags ----------------------------------------------------------------------------------------------------------

WIPES = """
    1 flag I2CSTR.BB 1
    5 flag I2CSTR.SDIR 1
    10 R I2CSTR 0x5410 f:1 SCD
    12 W I2CSTR 0x5430 f:1 SCD
    12 flag I2CSTR.SDIR 0 <4
"""
UNSEEN = "it rose in this transfer and the firmware has not looked at it"
ALONG = f"clears I2CSTR.{{}} along, by a bit-field write of another flag: {UNSEEN}"
PLAIN = f"clears I2CSTR.{{}} along, by a plain write: {UNSEEN}"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("10 R", "10 R", [(12, ALONG.format("SDIR"))]),
        ("10 R", "7 R I2CSTR 0x5410 g:1 SDIR\n10 R", []),
        ("10 R", "7 R I2CSTR 0x5410 g:1\n10 R", []),  # the whole register
        ("10 R", "7 R I2CSTR 0x5410 g:1 XRDY\n10 R", [(12, ALONG.format("SDIR"))]),
        ("5 flag", "3 R I2CSTR 0x1410 g:1 SDIR\n5 flag", [(12, ALONG.format("SDIR"))]),  # before it was set
        ("1 flag I2CSTR.BB 1", "", []),
        ("10 R", "8 flag I2CSTR.BB 1\n10 R", []),  # of an earlier transfer
        ("10 R", "9 flag I2CSTR.BB 0\n10 R", []),  # the transfer is over
        ("10 R", "9 flag I2CSTR.SCD 1\n10 R", []),
        ("10 R", "9 flag I2CSTR.SCD 0\n10 R", [(12, ALONG.format("SDIR"))]),
        ("12 W I2CSTR 0x5430 f:1 SCD", "12 W I2CSTR 0x5430 f:1 SDIR", []),  # it is the intended flag
        ("12 flag I2CSTR.SDIR 0 <4", "12 flag I2CSTR.SDIR 0", []),  # not cleared by a write
        ("12 W I2CSTR 0x5430 f:1 SCD", "12 W I2CMDR 0x0600 f:1", []),  # a reset of the module
        ("5 flag I2CSTR.SDIR 1", "5 flag I2CSTR.ARDY 1", []),
        ("10 R I2CSTR 0x5410 f:1 SCD\n", "", [(12, PLAIN.format("SDIR"))]),
    ],
)
def test_a_flag_cleared_along_with_another_one(old: str, new: str, said: list[tuple[int, str]]):
    text = changed(WIPES, old, new)
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    # A cause is a line number: replace it by the present line of the write.
    write = next(n for n, line in enumerate(lines, 1) if line.startswith("12 W"))
    text = "\n".join(line.replace("<4", f"<{write}") for line in lines)
    assert found("flag-wiped", text) == said


@pytest.mark.parametrize(
    ("value", "flags"),
    [("0xFFFF", ["SDIR", "RRDY"]), ("0x4028", []), ("0x4008", []), ("0x5008", ["SDIR", "RRDY"])],
)
def test_a_plain_write_of_only_flags_is_intended(value: str, flags: list[str]):
    of = f"""
        1 flag I2CSTR.BB 1
        5 flag I2CSTR.SDIR 1
        6 flag I2CSTR.RRDY 1
        12 W I2CSTR {value} f:1
        12 flag I2CSTR.SDIR 0 <4
        12 flag I2CSTR.RRDY 0 <4
    """
    assert found("flag-wiped", of) == [(12, PLAIN.format(flag)) for flag in flags]


STALE = "5 flag I2CSTR.SCD 1\n10 flag I2CSTR.BB 1\n20 R I2CSTR 0x1430 f:1 SCD"


@pytest.mark.parametrize(
    ("old", "new", "at"),
    [
        ("20 R", "20 R", [20]),
        ("5 flag", "3 flag I2CSTR.BB 1\n5 flag", [20]),  # the last START is decisive
        ("10 flag I2CSTR.BB 1", "10 flag I2CSTR.AAS 1", []),
        ("0x1430 f:1 SCD", "0x1410 f:1 SCD", []),
        ("0x1430 f:1 SCD", "0x1430 f:1 XRDY", []),
        ("0x1430 f:1 SCD", "0x1430 f:1", []),
        ("20 R", "15 flag I2CSTR.BB 0\n20 R", []),
        ("20 R", "15 flag I2CSTR.SCD 1\n20 R", []),
        ("20 R", "15 flag I2CSTR.SCD 0\n20 R", [20]),  # the value that was read is decisive
        ("0x1430 f:1 SCD", "0x1430 f:1 SCD\n22 W I2CSTR 0x1430 f:1 SCD", []),  # the read of a read-modify-write
        ("20 R I2CSTR", "20 W I2CSTR", []),
    ],
)
def test_a_wait_that_ends_because_of_a_stale_flag(old: str, new: str, at: list[int]):
    said = "sees I2CSTR.SCD = 1, which rose before this transfer began and was never cleared"
    text = changed(STALE, old, new)
    text = (
        text if new != "3 flag I2CSTR.BB 1" else "3 flag I2CSTR.BB 1\n5 flag I2CSTR.SCD 1\n20 R I2CSTR 0x1430 f:1 SCD"
    )
    assert found("stale-flag", text) == [(cycle, said) for cycle in at]


@pytest.mark.parametrize(("name", "mask"), [("SCD", 0x20), ("RRDY", 8), ("ARDY", 4), ("NACK", 2), ("SDIR", 0x4000)])
def test_the_flags_that_can_be_stale(name: str, mask: int):
    of = f"5 flag I2CSTR.{name} 1\n10 flag I2CSTR.BB 1\n20 R I2CSTR {0x1000 | mask} f:1 {name}"
    assert cycles("stale-flag", of) == ([20] if name != "SDIR" else [])


# Interrupts and waits -------------------------------------------------------------------------------------------

SERVED = "5 irq SCIRXINTA 1\n10 irq SCIRXINTA 0 <1"


@pytest.mark.parametrize(
    ("text", "at"),
    [
        (SERVED, [5]),
        (f"{SERVED}\n20 W PIE.PIEACK 0x100 f:1", []),
        (f"{SERVED}\n20 W PIE.PIEACK 0x080 f:1", [5]),
        (f"{SERVED}\n20 W PIE.PIEACK 0x1FF f:1", []),
        (f"{SERVED}\n20 R PIE.PIEACK 0x100 f:1", [5]),
        (f"3 W PIE.PIEACK 0x100 f:1\n{SERVED}".replace("<1", "<2"), [5]),
        ("5 irq SCIRXINTA 1\n7 W PIE.PIEACK 0x100 f:1 <1\n10 irq SCIRXINTA 0 <1", []),
        ("5 irq SCIRXINTA 1", []),  # the routine has not ended
        (f"{SERVED}\n30 irq SCIRXINTA 1", [5]),
        (f"{SERVED}\n30 irq SCIRXINTA 1\n40 irq SCIRXINTA 0 <3", [5, 30]),
        (f"{SERVED}\n20 W PIE.PIEACK 0x100 f:1\n30 irq SCIRXINTA 1\n40 irq SCIRXINTA 0 <4", [30]),
    ],
)
def test_a_group_that_is_never_acknowledged(text: str, at: list[int]):
    said = "SCIRXINTA is served, and PIEACK bit 8 is not written afterwards: no interrupt of group 9 comes any more"
    assert found("group-not-acknowledged", text) == [(cycle, said) for cycle in at]


WAIT = "10 R I2CSTR 0 f:1\n20 R I2CSTR 0 f:1\n{} R I2CSTR 8 g:2\n{} R I2CDRR 1 g:3"
LONG = 3_000_000  # cycles, 20 ms


def waits(text: str, end: int = 9_000_000, bound: Fraction | None = None) -> list[tuple[int, str]]:
    run = by_hand(*_rows(text), end=end)
    options = Options() if bound is None else Options(bound=bound)
    faults = [*all_lints()["spin-without-bound"].faults(run, options)]
    return [(int(run.table.tick[row]) // CYCLE, fault.text) for fault in faults for row in fault.rows.tolist()]


@pytest.mark.parametrize(
    ("next_at", "said"),
    [
        (LONG + 10, []),
        (LONG + 11, [(10, "polls I2C-A.I2CSTR for up to 20 ms (3000001 cycles)")]),
    ],
)
def test_a_wait_lasts_from_its_first_read_to_the_next_access_elsewhere(next_at: int, said: list[tuple[int, str]]):
    assert waits(WAIT.format(next_at, next_at + 5)) == said


def test_only_a_wait_longer_than_the_bound_is_reported():
    of = WAIT.format(160, 170)  # 1 us
    assert waits(of, bound=Fraction(1, 10**6)) == []
    (reported,) = waits(of, bound=Fraction(999, 10**9))
    assert reported == (10, "polls I2C-A.I2CSTR for up to 1 us (150 cycles)")


def test_one_read_or_writes_are_not_a_wait():
    assert waits(f"10 R I2CSTR 0 f:1\n{LONG + 99} R I2CDRR 0 g:2") == []
    assert waits(f"10 W I2CSTR 0 f:1\n20 W I2CSTR 0 f:1\n{LONG + 99} R I2CDRR 0 g:2") == []


def test_a_wait_at_the_end_of_the_run():
    stuck = "10 R I2CSTR 0 f:1\n20 R I2CSTR 0 f:1"
    said = "polls I2C-A.I2CSTR for up to {}, until the end of the run, and never got past it"
    assert waits(stuck, 160) == [(10, said.format("1 us (150 cycles)"))]
    once_past = f"{stuck}\n30 R I2CDRR 0 g:2\n40 R I2CSTR 0 f:1\n50 R I2CSTR 0 f:1"
    assert waits(once_past, 160) == []
    late = "polls I2C-A.I2CSTR for up to 20 ms (3000001 cycles), the last until the end of the run"
    assert waits(once_past, LONG + 41) == [(40, late)]
    assert waits(once_past, LONG + 40) == []


def test_a_wait_in_a_service_routine_ends_with_it():
    of = "5 irq SCIRXINTA 1\n10 R I2CSTR 0 f:1 <1\n20 R I2CSTR 0 f:1 <1\n30 irq SCIRXINTA 0 <1"
    assert waits(of) == [] == waits("5 irq SCIRXINTA 1\n10 R I2CSTR 0 f:1 <1\n20 R I2CSTR 0 f:1 <1")


def test_waits_of_one_place_are_one_fault_with_its_longest():
    poll, resume_after_halt = "{} R I2CSTR 0 f:1\n", "{} R I2CDRR 0 g:2\n"
    of = f"10 R I2CSTR 0 f:1\n20 R I2CSTR 0 f:1\n{resume_after_halt}{poll}{poll}{resume_after_halt}"
    run = by_hand(*_rows(of.format(LONG + 99, LONG + 100, LONG + 110, 2 * LONG + 500)), end=9_000_000)
    (fault,) = all_lints()["spin-without-bound"].faults(run, Options())
    assert (run.table.tick[fault.rows] // CYCLE).tolist() == [10, LONG + 100]
    assert fault.text == "polls I2C-A.I2CSTR for up to 20.003 ms (3000400 cycles)"
    assert fault.source == "SPRUG03B table 10"


PASS = "{} R I2CSTR 0 f:1\n{} R SCI-A.SCIRXST 0 f:2\n"
TWICE = PASS.format(10, 15) + PASS.format(20, 25)


@pytest.mark.parametrize(
    ("text", "end", "said"),
    [
        (f"{TWICE}{LONG + 11} R I2CDRR 1 g:3", 9_000_000, "for up to 20 ms (3000001 cycles)"),
        (f"{TWICE}{LONG + 10} R I2CDRR 1 g:3", 9_000_000, ""),
        (TWICE, 40, "for up to 200 ns (30 cycles), until the end of the run, and never got past it"),
        (f"{PASS.format(1, 2)}3 R I2CDRR 1 g:3\n{TWICE}", 40, ""),  # the loop ended after one pass before
        (PASS.format(10, 15), 40, ""),  # one pass is not a wait
        (TWICE.replace("I2CSTR", "I2CDRR"), 40, ""),  # it reads received data
        (f"{PASS.format(10, 15)}17 W I2CDXR 1 f:3\n{PASS.format(20, 25)}27 W I2CDXR 1 f:3", 40, ""),  # the loop writes
        (f"5 irq SCIRXINTA 1\n{TWICE}".replace(" f:1", " f:1 <1").replace(" f:2", " f:2 <1"), 40, ""),
    ],
)
def test_a_loop_that_reads_two_registers_is_a_wait(text: str, end: int, said: str):
    expected = [(10, f"polls I2C-A.I2CSTR and SCI-A.SCIRXST {said}")] if said else []
    assert waits(text, end) == expected


def loop(begin: int, reads: int, passes: int) -> list[str]:
    """Lines of a loop whose passes read `reads` registers each, one every 10 cycles."""
    registers = ("I2CSTR", "I2CMDR", "I2CCNT", "I2CSAR", "I2CPSC")[:reads] * passes
    return [f"{begin + 10 * n} R {name} 0 f:{n % reads}" for n, name in enumerate(registers)]


@pytest.mark.parametrize(("reads", "found_"), [(1, True), (2, True), (3, True), (4, True), (5, False)])
def test_a_pass_of_a_loop_has_up_to_four_reads(reads: int, found_: bool):
    names = ("I2CSTR", "I2CMDR", "I2CCNT", "I2CSAR")[:reads]
    said = f"polls {' and '.join(f'I2C-A.{name}' for name in names)} for up to 200 ns (30 cycles), until the end"
    reported = waits("\n".join(loop(100, reads, 3)), 130)
    assert [(cycle, text[: len(said)]) for cycle, text in reported] == [(100, said)] * found_


def test_the_longest_wait_of_a_loop_is_reported_and_a_unit_without_accesses_has_none():
    lines = [*loop(100, 2, 2), "150 W I2CCNT 1 g:1", *loop(1000, 2, 5), "1200 W I2CCNT 1 g:1", *loop(2000, 2, 3)]
    reported = found("spin-without-bound", "\n".join([*lines, "2100 W I2CCNT 1 g:1"]), Options(Fraction(1, 10**7)))
    assert reported == [
        (at, "polls I2C-A.I2CSTR and I2C-A.I2CMDR for up to 1.333 us (200 cycles)") for at in (100, 1000, 2000)
    ]
    run = by_hand(*_rows("\n".join(lines)), end=2100)  # the last wait is cut off by the end of the run
    (fault,) = all_lints()["spin-without-bound"].faults(run, Options(Fraction(1, 10**7)))
    assert fault.text.endswith(" for up to 1.333 us (200 cycles), the last until the end of the run")
    assert fault.source == "SPRUG03B table 10"  # of the first register
    assert found("spin-without-bound", "5 flag I2CSTR.BB 1") == []


def test_findings_are_one_per_place_in_the_order_of_their_first_times():
    of = f"{ON}20 W I2CDXR 1 b:1\n30 W I2CPSC 9 c:1\n30 flag I2CPSC.IPSC 9 <3\n"
    of += "40 W I2CCNT 6 a:1\n50 W I2CCNT 6 a:1\n60 W I2CCNT 6 d:1"
    reported = [(one.lint, one.place, one.count, one.first // CYCLE, one.unit) for one in lint(drawn(of))]
    assert reported == [
        ("prescaler-while-enabled", "c:1", 1, 30, "dsp"),
        ("without-effect", "a:1", 2, 40, "dsp"),
        ("without-effect", "d:1", 1, 60, "dsp"),
    ]


def test_the_first_time_of_a_place_is_the_earliest_of_all_routines():
    """`helper` polls in two routines:

    isr, entered at 5     helper polls from 10
    main                  helper polls from LONG + 200
    """
    poll = "{} R I2CSTR 0 helper:1{}\n{} R I2CSTR 0 helper:1{}\n{} W I2CDXR 1 g:2{}\n"
    text = "5 irq I2CINT1A 1\n" + poll.format(10, " <1", 20, " <1", LONG + 50, " <1")
    text += f"{LONG + 100} irq I2CINT1A 0 <1\n"
    text += poll.format(LONG + 200, "", LONG + 210, "", 2 * LONG + 500, "")
    run = by_hand(*_rows(text), end=9_000_000)
    (spin,) = [one for one in lint(run) if one.lint == "spin-without-bound"]
    assert (spin.place, spin.count, spin.first) == ("helper:1", 2, 10 * CYCLE)


def test_a_finding_without_a_source_is_shown_without_one():
    run = by_hand(*_rows("10 R X.UNKNOWN 0 f:1\n20 R X.UNKNOWN 0 f:1"), end=160)
    said = "dsp f:1: polls X.UNKNOWN for up to 1 us (150 cycles), until the end of the run, and never got past it"
    assert text(run, lint(run)).splitlines()[0] == said
