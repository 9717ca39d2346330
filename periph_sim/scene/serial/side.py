"""The parties of [serial] at the lines of SCIs: they send bursts ([[serial.send]]) and read replies.

events, times, replies --> Send --> BurstSender --> RX of an SCI
TX of an SCI --> UartReader --> Reply and Unsolicited (measures), TextTrigger
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial

from ...bus.uart.burst_sender import Burst, BurstSender, Character
from ...bus.uart.frame_format import UartFormat
from ...bus.uart.reader import Line, LineFrame, UartReader
from ...bus.uart.rs485 import Driver
from ...core.phrases import counted, did_you_mean
from ...core.records import Recorder
from ...timing.language.events import matcher
from ...timing.language.scope import BadEvent, Scope
from ...timing.measures.expectations import BAD, Expected, Reply, Unsolicited
from ...timing.measures.measure import MeasuredScene
from ..case.model import Case
from ..case.serial import (
    ExpectTable,
    SendTable,
    SerialEntry,
    SerialTable,
    content_of,
    encoded,
    show_characters,
)
from ..case.wiring import SciLines, sci_named
from ..context import SceneContext
from ..pairs import Pairs
from .send_schedule import EventTrigger, Send, TextTrigger

WHO = "serial"  # name of a party of [serial] in records and messages
IDLE_BITS = 11  # number of idle bits before a block in idle-line mode: ten, plus one because clocks differ
JUDGES = "a budget on 'unsolicited replies' judges them"
OFF = Fraction(5, 100)  # maximum relative amount by which an SCI may send faster than the nominal rate


class SerialSide:
    """The parties of the table [serial], which send bursts to SCIs and read their replies.

    A burst sends the characters of an entry of [[serial.send]] once. This object is created before the wires, so that
    the events for which the entries wait are recorded.
    """

    def __init__(self, case: Case, table: SerialTable, scope: Scope, recorder: Recorder) -> None:
        """Subscribe to the events of all entries. Raise BadCase for an invalid event."""
        self._case = case
        self._table = table
        self.sends: dict[str, Send] = {}
        self._replies: list[list[Reply]] = [[] for _ in table.expect]
        self._senders: dict[str, BurstSender] = {}
        self._silences: list[tuple[SciLines, Unsolicited]] = []
        self._readers: dict[tuple[str, Fraction, UartFormat], UartReader] = {}
        self._triggers: dict[tuple[str, int], EventTrigger] = {}
        self._unasked = Unsolicited("")  # counts unsolicited characters for the note on them
        self._is_judged = False  # True if a budget judges the unsolicited characters of all SCIs
        events = [("send", number, send.after) for number, send in enumerate(table.send)]
        events += [("expect", number, expect.after) for number, expect in enumerate(table.expect)]
        for kind, number, text in events:
            if text is not None:
                try:
                    event = matcher(text, scope)
                except BadEvent as error:
                    raise self._case.mistake(str(error), "serial", kind, number, "after") from None
                trigger = EventTrigger(event, partial(self._happened, kind, number))
                trigger.subscribe(recorder)
                self._triggers[kind, number] = trigger

    def attach(self, context: SceneContext, pairs: Pairs) -> None:
        """Connect senders and readers to the wires. Raise BadCase for an invalid entry of [serial]."""
        self._context = context
        self._pairs = pairs
        self._lines = {(sci.unit, sci.module): sci for sci in context.wiring.scis}
        for number, send in enumerate(self._table.send):
            self._attach_send(number, send)
        for number, expect in enumerate(self._table.expect):
            self._attach_expect(number, expect)

    def listen(self, scene: MeasuredScene) -> None:
        for trigger in self._triggers.values():
            trigger.listen(scene)
        self._unasked.listen(scene)
        self._is_judged = False

    @property
    def characters(self) -> int:
        """The number of characters that the parties of [serial] have sent."""
        return sum(sender.characters for sender in self._senders.values())

    def lines(self) -> Mapping[str, Line]:
        """Return a dictionary from a wire to a function that returns the bit length and format of the wire's sender."""
        return {wire: self._line_of(sender) for wire, sender in self._senders.items()}

    def on_reply(self, reply: Reply) -> tuple[Expected, Callable[[], str]]:
        """Add the measure of a reply. Raise BadEvent if the case does not expect this reply.

        Return the expected reply, and a function that returns why the reply was never due.
        """
        names = [expect.name for expect in self._table.expect]
        if reply.name not in names:
            raise BadEvent(f"no reply {reply.name!r} is expected; {did_you_mean(reply.name, names)}")
        number = names.index(reply.name)
        self._replies[number].append(reply)
        return self._expected(number), partial(self._why_never, number)

    def on_unsolicited(self, measure: Unsolicited) -> tuple[Callable[[tuple[int, ...]], str], Callable[[], str]]:
        """Add a measure of unsolicited characters.

        A measure with a name counts the characters in the silence that begins with the send of this name. A measure
        without a name counts the characters of all SCIs in [serial]. The measure for notes, `_unasked`, counts only
        characters of SCIs from which replies of one rate and format are expected.

        Raise BadEvent if the measure names a send that does not have `expect = "nothing"`.

        Return two functions. The first one formats characters as text. The second one returns the reason why the send
        with the name of the measure never began.
        """
        silences = [send.name or "" for send in self._table.send if send.expect is not None]
        if measure.name and measure.name not in silences:
            hint = did_you_mean(measure.name, silences)
            raise BadEvent(f'no send {measure.name!r} has expect = "nothing"; {hint}')
        self._is_judged |= not measure.name
        table, named = self._table, partial(sci_named, self._case)
        expected = {named(one.from_): one for one in reversed(table.expect)}
        scis = [] if measure.name else list(expected)
        if measure is not self._unasked:
            scis += [named(one.to) for one in table.send if measure.name in ("", one.name)]
        for sci in dict.fromkeys(scis):
            numbers = [number for number, one in enumerate(table.expect) if named(one.from_) == sci]
            if measure is self._unasked and len({self._line(table.expect[number]) for number in numbers}) > 1:
                continue  # the replies of this SCI differ in rate or format, so no format can read all characters
            self._listen(sci, expected.get(sci), partial(self._unexpected, measure, sci, numbers))
        if measure.name:
            self._silences.append((scis[0], measure))
            for one, send in zip(table.send, self.sends.values(), strict=True):
                if one.name == measure.name and one.within is not None:
                    send.on_begin.append(measure.window)
                    send.on_end.append(partial(self._silent, measure, self._context.ticks(one.within)))
                elif named(one.to) == scis[0]:
                    send.on_begin.append(measure.others_turn)
        as_text = any(one.text is not None for one in (*table.send, *table.expect))
        return partial(show_characters, as_text=as_text), lambda: self._never_sent(measure.name)

    def notes(self) -> list[str]:
        """Return notes on sends that never began, and on characters that no entry of [[serial.expect]] expects.

        Sends and characters about which a budget gives a verdict are left out.
        """
        judged = {expect.after_send for expect in self._table.expect}
        judged |= {send.name for send in self._table.send if send.expect is not None}
        silent = [send for name, send in self.sends.items() if not send.sent and name not in judged]
        notes = [f"serial: {self._never_sent(send.name)}" for send in silent]
        first = self._unasked.close(self._context.kernel.now)
        if first and not self._is_judged:
            notes.append(f"serial: {first} ({counted(self._unasked.worst, 'character')} in all); {JUDGES}")
        return notes

    def _never_sent(self, name: str) -> str:
        return f"send {name!r} never went out: {self.sends[name].why_never()}"

    # Sending bursts --------------------------------------------------------------------

    def _attach_send(self, number: int, table: SendTable) -> None:
        place = ("serial", "send", number)
        sci = sci_named(self._case, table.to, *place, "to")
        name = table.name or f"send {number}"
        if name in self.sends:
            raise self._case.mistake(f"there are two sends {name!r}; rename one of them", *place, "name")
        burst = self._burst(name, table, *place)
        sender = self._sender(sci, *place)
        send = self.sends[name] = Send(name, table, self._context, sender, burst, self._table.value("ppm", table))
        send.on_begin.append(partial(self._sent, sci))
        trigger = self._triggers.get(("send", number))
        if trigger is not None:
            send.why_unasked = trigger.missing
        wanted = table.after_bytes
        if table.after_text is not None:
            wanted = encoded(self._case, table.after_text, table, *place, "after_text")
        if wanted is not None:
            self._listen(sci, table, TextTrigger(wanted, send.happened).character)
            shown = show_characters(tuple(wanted), table.after_text is not None)
            send.why_unasked = lambda: f"{shown} never came from {table.to}"

    def _burst(self, name: str, table: SendTable, *place: str | int) -> Burst:
        (bit, form), ppm = self._line(table), self._table.value("ppm", table)
        if table.low is not None:
            return Burst(bit, form, low=self._context.ticks(table.low, ppm), name=name)
        mode = self._table.value("multiprocessor", table)
        data = content_of(self._case, table, form.bits, *place)
        if table.address is not None:
            if mode == "none":
                what = 'an address needs a mode that has them; give multiprocessor = "address-bit" or "idle-line"'
                raise self._case.mistake(what, *place, "address")
            if table.address >> form.bits:
                what = f"{table.address:#04x} does not fit a character of {form.bits} bits"
                raise self._case.mistake(what, *place, "address")
            data = bytes([table.address]) + data
        if table.wrong_parity and form.parity == "none":
            what = 'there is no parity that could be wrong; give parity = "even" or "odd"'
            raise self._case.mistake(what, *place, "wrong_parity")
        for key, places in (("wrong_parity", table.wrong_parity), ("missing_stop", table.missing_stop)):
            if places and max(places) >= len(data):
                what = f"there is no character {max(places)}; it sends {len(data)}, counted from 0"
                raise self._case.mistake(what, *place, key)
        characters = tuple(
            Character(
                value, int(n == 0 and table.address is not None), n in table.wrong_parity, n in table.missing_stop
            )
            for n, value in enumerate(data)
        )
        gap = self._context.ticks(table.gap, ppm)
        idle = IDLE_BITS if mode == "idle-line" and table.address is not None else 0
        return Burst(bit, form, characters, gap, idle=idle, name=name)

    def _sender(self, sci: SciLines, *place: str | int) -> BurstSender:
        """Return the sender to the RX of an SCI, or to its RS-485 pair."""
        transceiver = self._pairs.of(sci.unit, sci.module)
        wire = sci.rx if transceiver is None else transceiver.pair.wire.name
        if wire not in self._senders:
            kernel = self._context.kernel
            if transceiver is None:
                self._check_free(sci, *place)
                self._senders[wire] = BurstSender(kernel, self._context.wire(wire).attach(WHO), WHO)
            else:
                driver = Driver(transceiver.pair, WHO)
                hold = self._context.ticks(self._table.turnaround, self._table.ppm)
                self._senders[wire] = BurstSender(kernel, driver, WHO, hold)
                self._pairs.outside[WHO] = self._line_of(self._senders[wire])
        return self._senders[wire]

    def _check_free(self, sci: SciLines, *place: str | int) -> None:
        """Raise BadCase for a line that another party drives."""
        others = [f"{one.unit}.{one.module}.TX" for one in self._lines.values() if one.tx == sci.rx]
        if self._case.host is not None and sci.rx == "RX":
            others.append("the host")
        if self._case.outside is not None and sci.rx in self._case.outside.wires:
            others.append("the outside")
        if others:
            what = f"{others[0]} drives the RX of {sci.unit}.{sci.module} already, and one line has one sender"
            raise self._case.mistake(f"{what}; send to another SCI, or leave the other one out", *place, "to")

    # Expected replies ------------------------------------------------------------------

    def _attach_expect(self, number: int, table: ExpectTable) -> None:
        place = ("serial", "expect", number)
        self._listen(sci_named(self._case, table.from_, *place, "from"), table, partial(self._character, number))
        if table.after_send is not None:
            if table.after_send not in self.sends:
                raise self._case.unknown("send", table.after_send, self.sends, *place, "after_send")
            send = self.sends[table.after_send]
            if any(one.name == table.after_send and one.expect is not None for one in self._table.send):
                what = f"send {table.after_send!r} expects nothing; leave its key expect or this reply out"
                raise self._case.mistake(what, *place, "after_send")
            send.on_begin.append(partial(self._asked, number))
            send.on_end.append(partial(self._due, number))
        elif table.at is not None:
            tick = self._context.serial_tick(table.at, self._table.ppm)
            self._context.kernel.call_at(tick, lambda: self._happened("expect", number, tick))
        # A reply may begin together with the send that it answers. So its characters must fit into `within` plus the
        # duration of the send.
        count = len(self._expected(number).characters)
        takes = count * self._table.form(table).length * self._table.bit(table)
        may, echo = table.within, ""
        if table.after_send is not None:
            asks = Fraction(self.sends[table.after_send].ticks, self._context.timebase.per_second)
            may += asks
            echo = f", not even one that begins with send {table.after_send!r}, which takes {float(asks) * 1000:g} ms"
        if takes * (1 - OFF) > may:
            baud = 1 / self._table.bit(table)
            what = f"{count} characters take {float(takes) * 1000:g} ms at {baud} baud, so no reply can keep this{echo}"
            raise self._case.mistake(f"{what}; give it more time", *place, "within")

    def _expected(self, number: int) -> Expected:
        table, place = self._table.expect[number], ("serial", "expect", number)
        data = content_of(self._case, table, self._table.form(table).bits, *place)
        show = partial(show_characters, as_text=table.text is not None)
        within = self._context.ticks(table.within)
        return Expected(tuple(data), show, table.from_, within, table.anywhere)

    def _happened(self, kind: str, number: int, tick: int) -> None:
        if kind == "send":
            self.sends[self._table.send[number].name or f"send {number}"].happened(tick)
        else:
            self._asked(number, tick)
            self._due(number, tick)

    def _asked(self, number: int, tick: int) -> None:
        source = self._table.expect[number].from_
        for other, replies in zip(self._table.expect, self._replies, strict=True):
            if other.from_ == source and other is not self._table.expect[number]:
                for reply in replies:
                    reply.others_turn(tick)
        for sci, silence in self._silences:
            if sci == sci_named(self._case, source):
                silence.others_turn(tick)
        for reply in self._replies[number]:
            reply.window(tick)

    def _sent(self, sci: SciLines, tick: int) -> None:
        for expect, replies in zip(self._table.expect, self._replies, strict=True):
            if sci_named(self._case, expect.from_) == sci:
                for reply in replies:
                    reply.sent(tick)

    def _due(self, number: int, tick: int) -> None:
        for reply in self._replies[number]:
            reply.due(tick)

    def _character(self, number: int, frame: LineFrame) -> None:
        for reply in self._replies[number]:
            reply.character(frame.begin, frame.end, frame.value, frame.good)

    def _unexpected(self, measure: Unsolicited, sci: SciLines, expects: list[int], frame: LineFrame) -> None:
        """Pass a character to a measure of unsolicited characters, unless the character belongs to a reply.

        expects: the indices of the expected replies of this SCI. The measure for notes also ignores the characters
        after a send with `expect = "nothing"`, because a verdict reports them.
        """
        begin = frame.begin
        reported = any(reply.last == begin for number in expects for reply in self._replies[number])
        if measure is self._unasked:
            reported |= any(silence.forbids(begin) for one, silence in self._silences if one == sci)
        if not reported:
            value = frame.value if frame.good else BAD + frame.value
            measure.character(f"{sci.unit}.{sci.module}", begin, frame.end, value)

    def _silent(self, measure: Unsolicited, within: int, tick: int) -> None:
        measure.due(tick + within)

    def _why_never(self, number: int) -> str:
        table = self._table.expect[number]
        if table.after_send is not None:
            return self._never_sent(table.after_send)
        if ("expect", number) in self._triggers:
            return self._triggers["expect", number].missing()
        return "its time is after the end of the run"

    # Reading lines ------------------------------------------------------------------------

    def _listen(self, sci: SciLines, entry: SerialEntry | None, callback: Callable[[LineFrame], None]) -> None:
        """Call `callback` at the end of each character that an SCI sends, read with the rate and format of `entry`.

        On an RS-485 pair, a character is from this SCI only if it begins while the SCI's driver is on.
        """
        transceiver = self._pairs.of(sci.unit, sci.module)
        wire = sci.tx if transceiver is None else transceiver.pair.wire.name
        key = (wire, *self._line(entry))
        if key not in self._readers:
            self._readers[key] = UartReader(self._context.wire(wire), lambda: key[1:])
        if transceiver is not None:
            callback = partial(_if_driven, transceiver.driver, callback)
        self._readers[key].on_end.append(callback)

    def _line_of(self, sender: BurstSender) -> Line:
        idle = self._line()
        return lambda: sender.line or idle

    def _line(self, entry: SerialEntry | None = None) -> tuple[Fraction, UartFormat]:
        """Return the bit length, in ticks, and the format of an entry, or of the table if no entry is given."""
        return self._context.exact_ticks(self._table.bit(entry), self._table.value("ppm", entry)), self._table.form(
            entry
        )


def _if_driven(driver: Driver, callback: Callable[[LineFrame], None], frame: LineFrame) -> None:
    """Call `callback` with a UART frame if it began while the driver was on, because then this driver sent it."""
    if driver.was_on(frame.begin):
        callback(frame)
