"""Derivation of the records that budgets need, from transfers, frames, spans and wires.

    transfers, rounds, host frames --.
    wires, spans of firmware ---------+--> timing/derived --> TRANSFER, ROUND, DATA records
    SCIs, RX ----------------------------> SciMonitor, UartCounter --> RECEIVER records
    SCL, SDA ----------------------------> StuckWatch, if there is no controller agent --> BUS records

Only the records that a subscriber needs are derived.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from ..core.records import Kind, Recorder

if TYPE_CHECKING:
    from ..timing.derived.held_records import HeldRecords
    from ..timing.derived.origins import Origins
    from ..timing.derived.read_records import AgeRecords, ByteRecords
    from ..timing.derived.transfer_records import TransferRecords
    from .case.model import BadCase, Case
    from .scene import Scene


KINDS = (Kind.TRANSFER, Kind.ROUND, Kind.RECEIVER, Kind.DATA, Kind.BUS)
OF_UNITS = {"held alone", "unfinished"}  # the names (`what`) of the records that `HeldRecords` makes
# the names of the records that `ByteRecords`, `AgeRecords` and `ErrorRecords` make
OF_BYTES = {"bytes asked", "bytes compared", "wrong bytes", "expected byte", "zeros", "unknown bytes"}
OF_AGES = {"chip read", "age", "unknown age", "model age", "model run"}
OF_ERRORS = {"sample", "value error", "value error at frame", "unknown error"}
ERROR = re.compile("value error|unknown error")  # in the text of a measure that needs the true values
OF_MODELS = {"model age", "model run"}  # the names of the records that `AgeRecords` derives from spans of firmware
OF_ORIGINS = {"age", "unknown age"}  # the names of the records for which `AgeRecords` needs `Origins`


class DerivedRecords:
    """The objects that derive records in a scene.

    bytes: the object that compares read bytes with expected bytes; None if no subscriber needs the results.
    """

    def __init__(self, recorder: Recorder) -> None:
        """Subscribe to the spans of firmware if a subscriber needs the ages of the values that sensor models compute.

        Create this object after all other subscriptions and before the units.
        """
        self._recorder = recorder
        self._named = {kind: recorder.named_things(kind) for kind in KINDS}
        self._transfers: TransferRecords | None = None
        self._ages: AgeRecords | None = None
        self._held: list[HeldRecords] = []
        self.bytes: ByteRecords | None = None
        if self._named[Kind.DATA] & OF_MODELS:
            recorder.subscribe((Kind.SPAN,), self._age_records())

    def attach(self, scene: Scene) -> None:
        """Subscribe to the parts of a scene. All parts must have been built before.

        Raise BadCase if the expected bytes cannot be determined.
        """
        named = self._named
        if named[Kind.DATA]:
            self._attach_data(scene, named[Kind.DATA])
        has_bus = "SCL" in scene.wires and "SDA" in scene.wires
        if named[Kind.TRANSFER] & OF_UNITS and has_bus:
            from ..timing.derived.held_records import HeldRecords

            for unit in scene.units:
                if any(self._recorder.topic(Kind.TRANSFER, unit, what).has_subscribers for what in OF_UNITS):
                    self._held.append(HeldRecords(self._recorder, unit))
                    self._held[-1].attach(scene.wires["SCL"], scene.wires["SDA"])
        if named[Kind.TRANSFER] - OF_UNITS:
            from ..timing.derived.transfer_records import TransferRecords

            asked = scene.bus.asked
            self._transfers = TransferRecords(self._recorder, polls=asked is None or asked.ack_polling)
            scene.on_transfer(self._transfers.transfer)
        if named[Kind.ROUND]:
            from ..timing.derived.transfer_records import RoundRecords

            RoundRecords(self._recorder, scene.bus.rounds, scene.bus.period, scene.bus.starts)
        if named[Kind.RECEIVER]:
            scene.uart.record_receivers()
        if "stuck" in named[Kind.BUS] and has_bus and scene.head is None:  # a controller agent reports them itself
            from ..bus.i2c.line_observers import STUCK_AFTER, StuckWatch

            length = STUCK_AFTER if scene.case.rounds is None else scene.case.rounds.stuck_after
            limit = scene.timebase.ticks(length, "nearest")
            for name in ("SCL", "SDA"):
                StuckWatch(scene.wires[name], limit, scene.stuck.report, scene.bus.bit_skip)

    def finish(self, scene: Scene) -> None:
        """At the end of the run, record a refused transfer or hold of SCL that it cuts off, and the unjudged bytes."""
        now, monitor = scene.kernel.now, scene.bus.monitor
        if self._transfers is not None and monitor is not None:
            unfinished = None if scene.case.controller is not None else monitor.open_transfer
            self._transfers.finish(now, unfinished, monitor.held_since)
        for held in self._held:
            held.finish(now)
        if self.bytes is not None:
            self.bytes.finish(now)

    def _age_records(self) -> AgeRecords:
        if self._ages is None:
            from ..timing.derived.read_records import AgeRecords

            self._ages = AgeRecords(self._recorder)
        return self._ages

    def _attach_data(self, scene: Scene, named: set[str]) -> None:
        """Attach the objects that derive DATA records.

        `Origins` finds the host frame whose values a read returned. It is attached first, since the others use it.
        """
        checks_host = scene.case.checks_host
        origins: Origins | None = None
        if named & OF_ORIGINS or (named & OF_BYTES and checks_host):
            origins = _origins_of(scene)
            scene.on_frame(origins.frame)
            scene.on_transfer(origins.transfer)
        if named & OF_BYTES:
            from ..timing.derived.read_records import ByteRecords

            self.bytes = ByteRecords(self._recorder, origins if checks_host else None)
            scene.on_transfer(self.bytes.transfer)
        if named & OF_AGES:
            ages = self._age_records()
            ages.origins = origins if named & OF_ORIGINS else None
            scene.on_frame(ages.frame)
            scene.on_transfer(ages.transfer)
        if named & OF_ERRORS and scene.host_agent is not None:
            from ..timing.derived.error_records import ErrorRecords

            if scene.truth is None and named & OF_ERRORS != {"sample"}:
                raise _no_truth(scene)
            errors = ErrorRecords(self._recorder, scene.host_agent.truth_at, scene.host_agent.host.due)
            scene.on_frame(errors.frame)
            scene.on_transfer(errors.transfer)


MODEL_PIN = "MODEL"  # name, in a case, of the pin that is high while the firmware's models run


def _origins_of(scene: Scene) -> Origins:
    """Return an object that finds the host frame from which the bytes of a read come.

    Firmware with sensor models must hold a pin high while the models run, and the case must give this pin the name
    MODEL. Raise BadCase if the case of such firmware has no pin with this name, or if the firmware's settings do not
    determine the arithmetic of the models.
    """
    from ..core.sampler import watch
    from ..devices.host_frames import host_frames
    from ..timing.derived.origins import FrameOrigins, ModelOrigins

    if scene.model is None:
        return FrameOrigins(host_frames())
    codes = scene.model.codes()
    if codes is None:
        raise _mistake(scene.case, "the firmware has sensor models, but no setting states their arithmetic")
    if MODEL_PIN not in scene.wires:
        what = "the results of sensor models can be checked only with a pin that is high while they run"
        raise _mistake(scene.case, f"{what}; give the unit pins = {{ {MODEL_PIN} = 34 }}")
    origins = ModelOrigins(codes)
    watch([scene.wires[MODEL_PIN]], origins.model_pin)
    for dsp in scene.units.values():
        dsp.on_reset.append(origins.reset)
    return origins


def _no_truth(scene: Scene) -> BadCase:
    """Return an error about the first budget on errors of sensor models, in a scene without true values.

    If there is none, an event of [serial] names such an error, and the returned error is about [host].
    """
    of = [(entry, part) for entry, limit in enumerate(scene.limits) for part in limit.parts]
    found = [(entry, part.budget.measure) for entry, part in of if ERROR.search(part.plan.text)]
    place = ("budget", found[0][0], "measure") if found else ("host",)
    what = repr(found[0][1]) if found else "a value error"
    return scene.case.mistake(f"{what} of sensor models needs a motion to compare with; give [host.motion]", *place)


def _mistake(case: Case, what: str) -> BadCase:
    """Return an error about the key `check` of the table that defines the rounds: [rounds] or [controller]."""
    return case.mistake(what, "rounds" if case.line("rounds") else "controller", "check")
