"""Preparation of a replay from a case and a capture: the scene's case, and the transfers to play.

    capture --decode--> transfers --> turns --> the party of each address --> settings of the answering firmware

A turn is a part of a transfer that begins with a START and an address. The agent that the capture replaces is removed
from the case. Settings of the firmware that the case does not set are filled in from the capture, but only if the
firmware's module names them in `REPLAY`, because other firmware may use names such as `address` or `busy` for something
else.

The budgets of the case, which limit times, are removed: the verdict of a replay only says whether the wires agree with
the capture. Only a session, which replays an I2C capture and a UART capture together, judges budgets.
"""

from __future__ import annotations

import inspect
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, is_dataclass
from fractions import Fraction
from functools import cached_property
from statistics import median

from ..bus.i2c.replayed_sides import Answer
from ..core.phrases import counted
from ..scene.case.model import Case
from ..scene.firmware_loader import BadFirmware, load_firmware
from ..scene.scene import Scene
from ..traces.capture.capture import Capture, Channel, gap_notes
from ..traces.capture.sampling import rate_text, sample_step, stamp_notes
from ..traces.decode import i2c as decode
from ..traces.decode.i2c_table import impossible_rate, likely_cause
from ..traces.decode.uart import sample_point_step
from . import BadReplay
from .i2c_script import Turn, as_target, most_frequent, turns

LEAD = Fraction(1, 1000)  # seconds from the start of the firmware to the beginning of the capture
LONGEST = 24 * 3600  # maximum length of a replay, in simulated seconds


def unit_with(case: Case, module: str) -> str:
    """Return the name of the first unit that has a module. Raise BadCase if no unit has it."""
    for name, unit in case.unit.items():
        if module in unit.modules:
            return name
    raise case.mistake(f"no unit has {module}, which this capture is for; add it to a unit's modules", "unit")


def settings_of(case: Case, unit: str) -> frozenset[str]:
    """Return the names of the settings of a unit's firmware that a replay may fill in; none if there is no firmware.

    Raise BadCase if the firmware cannot be loaded.
    """
    if not case.unit[unit].firmware:
        return frozenset()
    try:
        return frozenset(load_firmware(case.unit[unit].firmware).replay)
    except BadFirmware as error:
        raise case.mistake(str(error), "unit", unit, "firmware") from None


def undeclared(case: Case, unit: str, names: Iterable[str]) -> list[str]:
    """Return a list with a note on the settings in `names` that the firmware has but does not name in `REPLAY`.

    A replay does not fill in these settings. The list is empty if there are none.
    """
    if not case.unit[unit].firmware:
        return []
    firmware = load_firmware(case.unit[unit].firmware)
    kind = firmware.settings
    known = inspect.signature(kind).parameters if inspect.isclass(kind) and is_dataclass(kind) else {}
    left = [name for name in names if name in known and name not in firmware.replay]
    if not left:
        return []
    return [
        f"settings of {firmware.name} that are not filled in from the capture, since its module does not name them in "
        f"REPLAY: {', '.join(left)}"
    ]


def alone(
    case: Case, unit: str, agent: str, forced: Mapping[str, object], offered: Mapping[str, object]
) -> tuple[Case, list[str]]:
    """Prepare a case for a replay: remove an agent and all budgets, and set settings of one unit's firmware.

    agent: "controller" or "host".
    forced: settings that are always set.
    offered: settings that are set if the firmware names them in `REPLAY` and the case does not set them.

    Return the prepared case, and the names of the offered settings that were set to a value other than zero or empty.
    """
    known = settings_of(case, unit)
    old = case.unit[unit]
    filled = {name: value for name, value in offered.items() if name in known - old.settings.keys()}
    settings = filled | old.settings | dict(forced)
    units = {**case.unit, unit: old.model_copy(update={"settings": settings})}
    prepared = case.model_copy(update={"unit": units, agent: None, "budget": ()})
    return prepared, [name for name, value in filled.items() if value]


def rate_of(capture: Capture) -> Fraction:
    """Return the number of positions per second in a capture. Raise InputError if it is unknown."""
    return capture.rate_for("a replay needs")


def check_length(capture: Capture, end: int) -> None:
    """Raise BadReplay if the capture up to position `end` is longer than LONGEST."""
    rate = rate_of(capture)
    if end > LONGEST * rate:
        raise BadReplay(
            f"{capture.path}: at {rate_text(rate)} there are {float(end / rate / 3600):.0f} hours to play; expected at "
            f"most {LONGEST // 3600}; state the right rate with --rate, or cut it with periph-sim convert --window"
        )


def tolerance_of(given: Fraction | None, rate: Fraction, scene: Scene) -> Fraction:
    """Return the largest time, in seconds, by which an event may be early or late.

    given: the user's tolerance. None selects a sample period plus a SYSCLKOUT cycle of the slowest unit, because edges
        of the capture are uncertain by a sample period, and the chip rounds its inputs to cycles.
    rate: samples per second.
    """
    if given is not None:
        return given
    return 1 / rate + max(1 / dsp.clock.hz for dsp in scene.units.values())


STEP = Fraction(25, 1000)  # simulated seconds between two progress reports
TAIL = Fraction(1, 10_000)  # seconds for which the wires are observed after the last move
PATIENCE = Fraction(200, 1000)  # default of `patience` in seconds; for comparison, an SHT21 stretches for up to 85 ms
BYTE = 9  # number of bits in a byte, with the ACK bit
LONG = Fraction(3, 2)  # a low phase is a stretch or a pause if it is longer than the usual one times this factor
HOLD = Fraction(300, 10**9)  # data hold time, in seconds, of targets that agents play: UM10204 Table 10


@dataclass
class Played:
    """The part of a capture that a replay plays. Positions are sample numbers or time stamps of the capture.

    lines: SCL and SDA.
    rate: the number of positions per second.
    whole: all transfers of the capture.
    transfers: the transfers that are played.
    turns: the turns of the played transfers.
    notes: notes for the report, for instance on parts that are not played.
    """

    capture: Capture
    lines: tuple[Channel, Channel]
    rate: Fraction
    whole: list[decode.Transfer]
    transfers: list[decode.Transfer]
    turns: list[Turn]
    notes: list[str] = field(default_factory=list)

    @cached_property
    def half_sample(self) -> Fraction:
        """Half a sample, in positions. Edges of SCL and SDA in the same sample are moved apart by this distance."""
        return Fraction(sample_step(self.capture), 2)

    @cached_property
    def step(self) -> int:
        """The number of positions from one sample to the next, which is the uncertainty of an edge.

        If the distances between all edges are multiples of one number, this number is assumed to be the distance of
        samples. But if the usual low time of SCL is shorter than twice this number, the multiples are due to the
        regular clock of the bus and say nothing about the samples. The result is then 1.
        """
        return sample_point_step(int(2 * self.half_sample), self.low)

    @property
    def sample_rate(self) -> Fraction:
        """The number of samples per second. `rate` is the number of positions per second."""
        return self.rate / self.step

    @cached_property
    def expected(self) -> list[decode.Event]:
        return events_of(self.transfers)

    @cached_property
    def low(self) -> Fraction:
        """The median low time of SCL before a bit, in positions; 0 if no bit has a known low time."""
        lows = [bit.low for bit in self.bits() if bit.low is not None]
        return Fraction(median(lows)) if lows else Fraction(0)

    @cached_property
    def long_low(self) -> Fraction:
        """The limit, in positions, above which a low phase before a bit is a stretch or a pause of the controller.

        It is the usual low time times LONG, but at least two samples more than the usual low time.
        """
        return max(self.low * LONG, self.low + 2 * self.step)

    @property
    def stretch(self) -> Fraction:
        """The longest low phase minus `low`, in positions; 0 if no low phase is longer than `long_low`."""
        longest = max((bit.low for bit in self.bits() if bit.low is not None), default=0)
        return longest - self.low if longest > self.long_low else Fraction(0)

    @cached_property
    def high(self) -> Fraction:
        """The median high time of SCL in a bit, in positions; 0 if no bit has a known high time."""
        highs = [bit.high for bit in self.bits() if bit.high is not None]
        return Fraction(median(highs)) if highs else Fraction(0)

    @cached_property
    def bit(self) -> float:
        """The length of a bit in seconds: the median low time plus the median high time of SCL."""
        return float((self.low + self.high) / self.rate)

    def bits(self) -> list[decode.Bit]:
        return [
            bit for transfer in self.transfers for phase in transfer.phases for byte in phase.bytes for bit in byte.bits
        ]

    def answers_of_others(self, own: Sequence[int]) -> dict[int, list[Answer]]:
        """Return the answers of the targets that the firmware does not replace, by address."""
        answers: dict[int, list[Answer]] = defaultdict(list)
        for turn in self.turns:
            if turn.address not in own:
                answers[turn.address].append(turn.answer)
        return answers


def played(capture: Capture, scl: str | int, sda: str | int, first: int | None = None) -> Played:
    """Decode the part of a capture that a replay plays. first: the maximum number of transfers; None for all.

    Raise BadReplay if the capture has no transfer, is too long (see `check_length`), or has a rate at which SCL would
    be too slow or too fast for I2C; InputError if its rate is unknown; LookupError if it has no such channel.
    """
    rate = rate_of(capture)
    if wrong := impossible_rate(capture, scl):
        raise BadReplay(f"{capture.path}: {wrong}; state the right rate with --rate")
    found = decode.transfers(capture, scl, sda)
    whole = [transfer for transfer in found if transfer.phases]
    wanted = whole[:first]
    if not wanted:
        raise BadReplay(f"{capture.path}: no I2C transfer on {scl!r} and {sda!r}; {likely_cause(capture, scl, sda)}")
    last = wanted[-1]
    check_length(capture, capture.length if last.stop is None else last.stop.at)
    notes = []
    if pulses := sum(len(transfer.lead) for transfer in found if not transfer.phases):
        notes.append(f"clock pulses before the capture's first START, of an unknown transfer, not played: {pulses}")
    if last.stop is None:
        cut_bytes = last.phases[-1].bytes
        bits = len(cut_bytes[-1].bits) if cut_bytes else 0
        inside = f"in the middle of a byte, after {counted(bits, 'bit')}" if 0 < bits < BYTE else "before a STOP"
        notes.append(f"the capture ends {inside}: the rest of its last transfer is not compared")
    if shared := decode.shared_edges(capture, scl, sda):
        notes.append(f"samples with an edge of both lines, in which SDA's edge is moved by half a sample: {shared}")
    notes += stamp_notes(capture)
    lines = capture.channel(scl), capture.channel(sda)
    notes += gap_notes(capture, *lines)
    return Played(capture, lines, rate, whole, wanted, list(turns(wanted)), notes)


def events_of(transfers: Sequence[decode.Transfer]) -> list[decode.Event]:
    """Return the events of several transfers, in order."""
    return [event for transfer in transfers for event in decode.events_of(transfer)]


@dataclass
class Answering:
    """The unit that replaces captured targets.

    own: the addresses of the unit.
    asked: how often any of these addresses is acknowledged in the capture. If the number is 0, the capture does not
        require anything of the firmware.
    forced: settings of the firmware that the replay always sets.
    offered: settings that the replay sets if the firmware names them in `REPLAY` and the case does not set them.
    """

    unit: str
    own: list[int]
    asked: int = 0
    forced: dict[str, object] = field(default_factory=dict)
    offered: dict[str, object] = field(default_factory=dict)

    @property
    def unjudged(self) -> str:
        """The reason why a replay without differences proves nothing; "" if it proves something."""
        if self.asked:
            return ""
        addresses = ", ".join(f"{address:02X}" for address in self.own)
        return f"nothing was required of the firmware: {addresses or 'an address'} is not acknowledged in the capture"


def answering(case: Case, part: Played, given: Sequence[int], lead: Fraction = LEAD) -> Answering:
    """Determine the firmware's addresses and settings. Add notes to `part`, for example on settings not filled in.

    `REPLAY` is the firmware's list of the settings that a replay may fill in.

    given: the addresses that the user states; empty if the user states none. The firmware's addresses are:
        - `given`, if it is not empty.
        - Otherwise, if `REPLAY` does not name `address`: all addresses of the capture.
        - Otherwise, the address that the case sets. If it sets none, the address that was acknowledged most often in
          the capture.

    If `REPLAY` names `address` and the firmware has one address, settings are filled in: the address, the captured
    replies, and the times at which the captured target did not acknowledge its address. If the user states the address,
    these times are not filled in. To agree with the capture, the firmware must then send these NACKs by itself.

    Raise BadReplay if `REPLAY` names `address`, and several addresses are given or no address is found.
    """
    unit = unit_with(case, "I2C-A")
    found = Answering(unit, _addresses(case, unit, part, given))
    own = [turn for turn in part.turns if turn.address in found.own]
    found.asked = sum(turn.answer.ack for turn in own)
    if not own:
        part.notes.append(f"the capture does not ask {', '.join(f'{address:02X}' for address in found.own)}")
    part.notes += undeclared(case, unit, ("address", "replies", "asleep", "busy"))
    if len(found.own) == 1 and "address" in settings_of(case, unit):
        found.offered = _settings(part, found.own[0], lead, in_reach=bool(given))
        found.forced = {"address": found.own[0]}
    return found


def _addresses(case: Case, unit: str, part: Played, given: Sequence[int]) -> list[int]:
    if len(given) > 1 and "address" in settings_of(case, unit):
        raise BadReplay(f"firmware {case.unit[unit].firmware} answers one address; {len(given)} are given")
    if given:
        return list(given)
    if "address" not in settings_of(case, unit):
        return sorted({turn.address for turn in part.turns})
    if "address" in case.unit[unit].settings:
        own = case.unit[unit].settings["address"]
        return [own] if isinstance(own, int) else []
    address = most_frequent(part.turns)
    if address is None:
        raise BadReplay(f"{part.capture.path}: no whole address byte; the capture may be cut or its lines swapped")
    return [address]


def _settings(part: Played, address: int, lead: Fraction, in_reach: bool) -> dict[str, object]:
    last = part.transfers[-1]
    end = max(last.phases[-1].start.at, 0 if last.stop is None else last.stop.at)
    target = as_target(address, part.turns, end + int(part.rate))
    if in_reach:
        return {"replies": target.replies}
    if target.refused:
        part.notes.append(
            f"NACKs of {target.address:02X} that the firmware cannot be set to repeat, because they follow neither a "
            f"write with a STOP nor the start of the capture: {target.refused}"
        )
    answered = [turn.answer.ack for turn in part.turns if turn.address == address]
    if answered and not any(answered):
        part.notes.append(f"{address:02X} is not acknowledged in the capture: the firmware does not answer")
    asleep = Fraction(0) if target.asleep is None else target.asleep / part.rate + lead
    return {
        "replies": target.replies,
        "asleep": asleep,
        "busy": [pause / part.rate for pause in target.busy] if any(target.busy) else [],
    }
