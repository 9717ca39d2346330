"""Measures as text: the meaning of each form, and the messages about texts that are not measures."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from periph_sim.timing.language.events import Event, event_of
from periph_sim.timing.language.language import FORMS, ParsedMeasure, is_form, measure_of, near_form
from periph_sim.timing.language.scope import BadEvent
from periph_sim.timing.language.tokens import Words
from tests.scene.small import sentence_of


@pytest.mark.parametrize(
    ("text", "kind", "unit", "name", "how", "number"),
    [
        ("edge SCL rise", "edge", "", "SCL", "rise", None),
        ("edge  SCL   change", "edge", "", "SCL", "change", None),
        ("flag I2C-A.I2CSTR.XRDY fall", "flag", "", "I2C-A.I2CSTR.XRDY", "fall", None),
        ("flag imu:I2C-A.I2CSTR.XRDY rise", "flag", "imu", "I2C-A.I2CSTR.XRDY", "rise", None),
        ("flag SCI-A.SCIFFRX.RXFFST = 12", "flag", "", "SCI-A.SCIFFRX.RXFFST", "=", 12),
        ("flag I2C-A.I2COAR.OAR=0x68", "flag", "", "I2C-A.I2COAR.OAR", "=", 0x68),
        ("access W I2C-A.I2CDXR", "access", "", "I2C-A.I2CDXR", "W", None),
        ("interrupt imu:SCIRXINTA enter", "interrupt", "imu", "SCIRXINTA", "enter", None),
        ("span model begin", "span", "", "model", "begin", None),
        ("span time update end", "span", "", "time update", "end", None),
        ('span "from begin to end" end', "span", "", "from begin to end", "end", None),
        ("span imu:'a b' begin", "span", "imu", "a b", "begin", None),
        ("bus START", "bus", "", "START", "", None),
        ("bus repeated START", "bus", "", "repeated START", "", None),
        ("bus arbitration lost", "bus", "", "arbitration lost", "", None),
        ("bus address", "bus", "", "address", "", None),
        ("bus address 0x68", "bus", "", "address", "", 0x68),
        ("bus address 104 read", "bus", "", "address", "read", 104),
        ("bus address write", "bus", "", "address", "write", None),
        ("bus address 0x50 read ACK", "bus", "", "address", "read ACK", 0x50),
        ("bus byte 0xFF", "bus", "", "byte", "", 255),
        ("bus NACK", "bus", "", "NACK", "", None),
        ("frame", "frame", "", "RX", "begin", None),
        ("frame 0x55", "frame", "", "RX", "end", 0x55),
        ("frame TX 0x55 end", "frame", "", "TX", "end", 0x55),
        ("frame RX error", "frame", "", "RX", "error", None),
        ("note imu:duty", "note", "imu", "duty", "", None),
    ],
)
def test_an_event(text: str, kind: str, unit: str, name: str, how: str, number: int | None):
    event = event_of(text)
    assert (event.kind, event.unit, event.name, event.how, event.number) == (kind, unit, name, how, number)


@pytest.mark.parametrize(
    ("text", "form", "events", "rules", "unit", "name"),
    [
        ("from bus START to bus STOP", "from", ["bus START", "bus STOP"], "", "", ""),
        ("from frame to edge TX fall, next", "from", ["frame", "edge TX fall"], "next", "", ""),
        ("from bus byte 7 to frame same transfer", "from", ["bus byte 7", "frame"], ",transfer", "", ""),
        ("from bus byte to frame, same round", "from", ["bus byte", "frame"], ",round", "", ""),
        ("from frame to frame TX, in order", "from", ["frame", "frame TX"], "in order", "", ""),
        ("from frame to frame TX, last, same round", "from", ["frame", "frame TX"], "last,round", "", ""),
        ("from frame to frame, last, same unit", "from", ["frame", "frame"], "last,unit", "", ""),
        ("from frame to frame TX same round next", "from", ["frame", "frame TX"], "next,round", "", ""),
        ("from span a b begin to span a b end", "from", ["span a b begin", "span a b end"], "", "", ""),
        ("from last bus byte of round to frame", "from", ["last bus byte of round", "frame"], "", "", ""),
        ("from bus STOP or frame to frame TX", "from", ["bus STOP or frame", "frame TX"], "", "", ""),
        ("period of frame", "period", ["frame"], "", "", ""),
        ("period of 12th frame RX of burst", "period", ["12th frame RX of burst"], "", "", ""),
        ("jitter of span model begin", "jitter", ["span model begin"], "", "", ""),
        ("jitter of response", "jitter", [], "", "", "response"),
        ("count of note lost", "count", ["note lost"], "", "", ""),
        (
            "count of frame from bus START to bus STOP, last",
            "count",
            ["frame", "bus START", "bus STOP"],
            "last",
            "",
            "",
        ),
        (
            "level of imu:SCI-A.SCIFFRX.RXFFST",
            "level",
            ["flag imu:SCI-A.SCIFFRX.RXFFST change"],
            "",
            "imu",
            "SCI-A.SCIFFRX.RXFFST",
        ),
        (
            "level of SCI-A.SCIFFRX.RXFFST at frame",
            "level",
            ["flag SCI-A.SCIFFRX.RXFFST change", "frame"],
            "",
            "",
            "SCI-A.SCIFFRX.RXFFST",
        ),
        ("level of variable imu:_count", "level", ["variable imu:_count change"], "", "imu", "_count"),
        ("calls of imu:_isr", "calls", ["span imu:_isr begin"], "", "", ""),
        ("stack high-water of imu", "stack", [], "", "imu", ""),
        ("interrupt latency SCIRXINTA", "interrupt", [], "", "", "SCIRXINTA"),
        ("reaction of imu", "reaction", [], "", "imu", ""),
        ("busy time of 0x50", "busy", [], "", "", "0x50"),
        ("gap between rounds", "gap", [], "", "", ""),
        ("cpu load", "cpu", [], "", "", ""),
        ("cpu load of imu", "cpu", [], "", "imu", ""),
        ("bus load", "bus", [], "", "", ""),
        ("slack", "slack", [], "", "", ""),
        ("race imu:I2C-A.I2CSTR", "race", [], "", "imu", "I2C-A.I2CSTR"),
        ("cleared along I2C-A.I2CSTR.SDIR", "cleared", [], "", "", "I2C-A.I2CSTR.SDIR"),
        ("lost flags", "lost", [], "", "", ""),
        ("lost flags I2C-A.I2CSTR", "lost", [], "", "", "I2C-A.I2CSTR"),
    ],
)
def test_a_measure(text: str, form: str, events: list[str], rules: str, unit: str, name: str):
    assert is_form(text)
    said = measure_of(text)
    assert [event.text for event in said.events] == events
    pairing, _, group = rules.partition(",")
    assert said == ParsedMeasure(form, said.events, text, unit=unit, name=name, pairing=pairing, group=group)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("value error", ParsedMeasure("value", instant="first bit")),
        ("value error of gyroscope at first bit", ParsedMeasure("value", name="gyroscope", instant="first bit")),
        ("value error at frame", ParsedMeasure("value", instant="frame")),
        ("cpu load of imu per 20 ms", ParsedMeasure("cpu", unit="imu", window="20 ms")),
        ("bus load per 1.5 s", ParsedMeasure("bus", window="1.5 s")),
        ("interrupt latency XINT1 to first access", ParsedMeasure("interrupt", name="XINT1", access=True)),
        ("jitter of slack", ParsedMeasure("jitter", of=ParsedMeasure("slack"))),
        ("jitter of interrupt latency XINT1", ParsedMeasure("jitter", of=ParsedMeasure("interrupt", name="XINT1"))),
        ("jitter of bus load", ParsedMeasure("jitter", of=ParsedMeasure("bus"))),
        ("jitter of age of gyroscope", ParsedMeasure("jitter", of=ParsedMeasure("age", name="gyroscope"))),
        ("jitter of span:model and more", ParsedMeasure("jitter", name="span:model and more")),
        ("SCL held per transfer", ParsedMeasure("SCL")),
        ("SCL held per transfer by imu", ParsedMeasure("SCL", unit="imu")),
        ("margin of imu:I2CDXR", ParsedMeasure("margin", unit="imu")),
        ("margin of I2C-A.I2CDXR", ParsedMeasure("margin")),
        ("reaction", ParsedMeasure("reaction")),
        ("model age of magnetometer", ParsedMeasure("model", name="magnetometer")),
        ("model age", ParsedMeasure("model")),
        ("interrupt latency imu:XINT1", ParsedMeasure("interrupt", unit="imu", name="XINT1")),
    ],
)
def test_further_parts_of_a_measure(text: str, said: ParsedMeasure):
    assert replace(measure_of(text), text="") == said


@pytest.mark.parametrize(
    ("text", "nth", "group"),
    [
        ("first bus byte of transfer", 1, "transfer"),
        ("1st frame TX of burst", 1, "burst"),
        ("last frame RX end of burst", -1, "burst"),
        ("22nd edge SCL rise of round", 22, "round"),
    ],
)
def test_the_nth_event_of_a_transfer_round_or_burst(text: str, nth: int, group: str):
    event = event_of(text)
    assert (event.nth, event.group, event.text) == (nth, group, text)


def test_alternative_events():
    event = event_of("bus STOP or frame TX end or span a begin")
    assert (event.kind, [other.text for other in event.others]) == ("bus", ["frame TX end", "span a begin"])


@pytest.mark.parametrize(
    ("text", "enters", "leaves"),
    [
        ("time update", ["span time update begin"], ["span time update end"]),
        ("span bus driver", ["span bus driver begin"], ["span bus driver end"]),
        ("'wire SCL low'", ["span 'wire SCL low' begin"], ["span 'wire SCL low' end"]),
        ("flag imu:I2C-A.I2CSTR.AAS = 1", ["flag imu:I2C-A.I2CSTR.AAS = 1"], ["flag imu:I2C-A.I2CSTR.AAS change"]),
        ("wire SCL low", ["edge SCL fall"], ["edge SCL rise"]),
        ("wire MODEL high", ["edge MODEL rise"], ["edge MODEL fall"]),
        ("bus busy", ["bus START"], ["bus STOP", "bus arbitration lost"]),
        ("bus free", ["bus STOP", "bus arbitration lost"], ["bus START"]),
        ("interrupt SCIRXINTA", ["interrupt SCIRXINTA enter"], ["interrupt SCIRXINTA leave"]),
    ],
)
def test_a_state_has_events_that_enter_and_leave_it(text: str, enters: list[str], leaves: list[str]):
    for form in ("time", "each time"):
        state = measure_of(f"{form} in {text}").state
        assert state.text == text
        assert [event.text for event in state.enters] == enters
        assert [event.text for event in state.leaves] == leaves
        for event in (*state.enters, *state.leaves):
            assert "'" in event.text or event == event_of(event.text)  # the same as the event written out


@pytest.mark.parametrize("name", ["wait to send", "read or write", "end of frame", "load, run"])
def test_all_words_after_in_are_the_name_of_a_span(name: str):
    state = measure_of(f"time in {name}").state
    begin, end = (*state.enters, *state.leaves)
    called = measure_of(f"calls of span {name}").events
    assert (begin.name, begin.how, end.name, end.how) == (name.replace(",", " ,"), "begin", begin.name, "end")
    assert called == (begin,)


@pytest.mark.parametrize("form", FORMS.values())
def test_every_form_named_in_messages_can_be_parsed(form: str):
    text = (
        form.replace("MODULE.REGISTER.FIELD", "I2C-A.I2CSTR.XRDY")
        .replace("NAME", "SCIRXINTA")
        .replace("ADDRESS", "0x50")
    )
    assert measure_of(text.replace("EVENT", "frame").replace("STATE", "model").replace("CHIP", "gyroscope"))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("from edge SCL rise", "'from edge SCL rise' ends where to is expected"),
        (
            "from edge SCL rize to frame",
            "'from edge SCL rize to frame': 'rize' where rise, fall or change is expected; did you mean rise?",
        ),
        ("edge SCL", "'edge SCL' ends where rise, fall or change is expected"),
        ("edge", "'edge' ends where a wire is expected"),
        (
            "flg I2C-A.I2CSTR.XRDY rise",
            "'flg I2C-A.I2CSTR.XRDY rise': 'flg' where edge, flag, access, interrupt, span, bus, frame, variable, "
            "note or record is expected; did you mean flag?",
        ),
        ("flag I2C-A.I2CCNT.ICDC =", "'flag I2C-A.I2CCNT.ICDC =': a number is expected after ="),
        ("count of bus address 0x80", "'count of bus address 0x80': 0x80 is more than it can be, 0x7f"),
        ("count of bus byte 0xZZ", "'count of bus byte 0xZZ': '0xZZ' is no number; write for instance 0x68"),
        ("note dutty", "'note dutty': there is no note 'dutty'; did you mean duty?"),
        (
            "from frame to frame, same frame",
            "'from frame to frame, same frame': 'frame' where transfer, round or unit is expected; it has transfer, "
            "round, unit",
        ),
        (
            "from frame to frame TX, next, last",
            "'from frame to frame TX, next, last': 'last' where same is expected",
        ),
        ("from frame to frame TX, in oder", "'from frame to frame TX, in oder': 'oder' where order is expected"),
        ("last bus byte", "'last bus byte' ends where of is expected"),
        (
            "first bus byte of frame",
            "'first bus byte of frame': 'frame' where transfer, round, burst or interrupt is expected; it has "
            "transfer, round, burst, interrupt",
        ),
        ("0th bus byte of round", "'0th bus byte of round': '0th', but counting begins with 1st"),
        ("cpu load per", "'cpu load per' ends where the length of a window is expected; write for instance per 20 ms"),
        ("bus load per 20", "'bus load per 20': '20' has no unit; write for instance 20 ms (ns, us, ms, s, min, h, d)"),
        ("bus load per 0 s", "'bus load per 0 s': a window is longer than 0"),
        ("interrupt latency XINT1 to access", "'interrupt latency XINT1 to access': 'access' where first is expected"),
        ("gap between transfers", "'gap between transfers': 'transfers' where rounds is expected"),
        ("busy time of it", "'busy time of it': the address of a memory is expected after of; write for instance 0x50"),
        ("reaction of", "'reaction of' ends where a unit is expected"),
        ("margin of I2CDRR", "'margin of I2CDRR': only I2CDXR has a margin; write margin of I2CDXR"),
        ("margin I2CDXR", "'margin I2CDXR': 'I2CDXR' where of is expected"),
        ("jitter of", "'jitter of' ends where a measure or an event is expected"),
        ("SCL held per transfer by", "'SCL held per transfer by' ends where a unit is expected"),
        ("SCL held by imu", "'SCL held by imu': 'by' where per is expected"),
        ("level of", "'level of' ends where a field is expected"),
        ("lost flag", "'lost flag': 'flag' where flags is expected"),
        ("cleared along", "'cleared along' ends where a field is expected"),
        ("race", "'race' ends where a field or a register is expected"),
        ("margin of", "'margin of' ends where I2CDXR is expected"),
        ("interrupt latency", "'interrupt latency' ends where an interrupt's name is expected"),
        ("count of interrupt XINT1", "'count of interrupt XINT1' ends where enter or leave is expected"),
        ("access R", "'access R' ends where a register is expected"),
        ("note", "'note' ends where a note's code is expected"),
        ("count of bus arbitration", "'count of bus arbitration' ends where lost is expected"),
        ("count of bus repeated STOP", "'count of bus repeated STOP': 'STOP' where START is expected"),
        ("time in", "'time in' ends where a span's name is expected"),
        ("time in wire", "'time in wire' ends where a wire is expected"),
        ("time in interrupt", "'time in interrupt' ends where an interrupt's name is expected"),
        ("time in flag", "'time in flag' ends where a field is expected"),
        ("time in flag A.B.C =", "'time in flag A.B.C =': a number is expected after ="),
        (
            "period of frame RX frame",
            "'period of frame RX frame': 'frame' is more than a measure or event says; leave it out",
        ),
        ("from frame to frame,", "'from frame to frame,' ends where in, next, last or same is expected"),
        (
            "from frame to frame, next, nxt",
            "'from frame to frame, next, nxt': 'nxt' where same is expected",
        ),
        (
            "from frame to frame, same round, lst",
            "'from frame to frame, same round, lst': 'lst' where in, next or last is expected; did you mean last?",
        ),
        (
            "from frame to frame, next, same round, last",
            "'from frame to frame, next, same round, last': ',' is more than a measure or event says; leave it out",
        ),
        ("slack of it", "'slack of it': 'of' is more than a measure or event says; leave it out"),
        ("cpu", "'cpu' ends where load is expected"),
        ("bus of dsp", "'bus of dsp': 'of' where load is expected"),
        ("cpu load of", "'cpu load of' ends where a unit is expected"),
        ("period edge SCL rise", "'period edge SCL rise': 'edge' where of is expected"),
        ("time in wire SCL", "'time in wire SCL' ends where high or low is expected"),
        ("time in flag I2C-A.I2CSTR.AAS", "'time in flag I2C-A.I2CSTR.AAS' ends where = is expected"),
        (
            "each time in bus bussy",
            "'each time in bus bussy': 'bussy' where busy or free is expected; did you mean busy?",
        ),
        (
            "value error of gyro",
            "'value error of gyro': 'gyro' where gyroscope, accelerometer or magnetometer is expected; "
            "did you mean gyroscope?",
        ),
        ("value error at bit", "'value error at bit': 'bit' where first or frame is expected; it has first, frame"),
        ("each in bus busy", "'each in bus busy': 'in' where time is expected"),
        ("span model", "'span model' ends where begin or end is expected"),
        ("time in ''", "\"time in ''\": a quote is not closed, or nothing is in it; write for instance 'time update'"),
        (
            'span "a begin',
            "'span \"a begin': a quote is not closed, or nothing is in it; write for instance 'time update'",
        ),
        ("span imu:", "'span imu:' ends where a span's name is expected"),
        (
            "record transfer phase of dsp",
            "'record transfer phase of dsp': 'dsp' where an address is expected; write for instance 0x68",
        ),
        (
            "record transfer refused of 0x50",
            "'record transfer refused of 0x50': 'of' is more than a measure or event says; leave it out",
        ),
        ("record transfer read of 0x80", "'record transfer read of 0x80': 0x80 is more than it can be, 0x7f"),
        ("", "'' ends where edge, flag, access, interrupt, span, bus, frame, variable, note or record is expected"),
    ],
)
def test_an_invalid_event_or_measure_is_rejected_with_what_was_expected(text: str, sentence: str):
    assert sentence_of(BadEvent, lambda: measure_of(text) if is_form(text) else event_of(text)) == sentence


def test_a_mistyped_first_word_has_a_near_form():
    assert near_form("perod of frame") == "period of EVENT"
    assert near_form("respons") == ""


def test_an_event_has_its_text_without_extra_spaces():
    assert measure_of("from  bus   START to frame").events[0] == Event("bus", "bus START", "", "START")


@pytest.mark.parametrize(
    ("text", "most", "shown"),
    [
        ("bus address {}", 0x7F, "0x7f"),
        ("bus byte {}", 0xFF, "0xff"),
        ("frame {}", 0xFF, "0xff"),
        ("flag A.B.C = {}", 0xFFFF_FFFF, "0xffffffff"),
    ],
)
def test_the_largest_number(text: str, most: int, shown: str):
    assert event_of(text.format(most)).number == most
    with pytest.raises(BadEvent, match=f"{most + 1:#x} is more than it can be, {shown}"):
        event_of(text.format(hex(most + 1)))
    assert event_of(text.format(0)).number == 0


def test_the_largest_number_of_a_state():
    state = measure_of("time in flag A.B.C = 0xFFFFFFFF").state
    assert state.enters[0].number == 0xFFFF_FFFF
    with pytest.raises(BadEvent, match="0x100000000 is more than it can be"):
        measure_of("time in flag A.B.C = 0x100000000")


def test_the_next_and_the_following_word():
    words = Words("a 'b c', d=7")
    assert (words.next, words.following) == ("a", "'b c'")
    assert words.take("a word") == "a" and words.name("a name") == ("", "b c")
    assert (words.place, words.between(1), words.took("x"), words.took(",")) == (2, "'b c'", False, True)
    assert words.rest() == "d = 7" and (words.next, words.following, words.rest()) == ("", "", "")
    words.end()
    assert Words("a").following == ""


def test_a_space_is_allowed_between_unit_and_name():
    assert Words("imu: 'a b'").name("a name") == Words("imu:'a b'").name("a name") == ("imu", "a b")
    assert Words("imu: a").name("a name") == ("imu", "a")


@pytest.mark.parametrize(("word", "number"), [("7", 7), ("0x1F", 31), ("0b11", 3), ("x7", None), ("", None)])
def test_a_number_is_read_only_if_the_next_word_is_one(word: str, number: int | None):
    words = Words(word)
    assert words.number(31) == number
    assert words.next == ("" if number is not None else word)


@pytest.mark.parametrize(
    ("text", "form"),
    [
        ("cout of frame", "count of EVENT"),
        ("racee X", "race MODULE.REGISTER.FIELD"),
        ("frm X", "from EVENT to EVENT"),
        ("perio of", "period of EVENT"),
        ("ag", "age of CHIP"),
        ("pace", "race MODULE.REGISTER.FIELD"),
        ("paces", ""),
        ("responses", ""),
    ],
)
def test_the_form_whose_first_word_is_similar_to_that_of_a_text(text: str, form: str):
    assert near_form(text) == form and not is_form(text)


def test_a_comma_is_allowed_after_the_first_word():
    assert is_form("slack, x") and not is_form("slack:x")
