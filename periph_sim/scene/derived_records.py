"""Derives records that budgets need from transfers, frames and wires, with the modules in `timing/derived`.

    transfers, rounds --.
    host frames ---------+--> timing/derived --> TRANSFER, ROUND, DATA records
    SCIs, RX ------------'--> SciMonitor, characters --> RECEIVER records
    SCL, SDA -------------> StuckWatch, where no controller watches them --> BUS records

Only the records that a subscriber needs are derived.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core.records import Kind, Recorder

if TYPE_CHECKING:
    from ..timing.derived.age_records import AgeRecords
    from ..timing.derived.byte_records import ByteRecords
    from ..timing.derived.origins import Origins
    from ..timing.derived.transfer_records import TransferRecords
    from .scene import Scene

KINDS = (Kind.TRANSFER, Kind.ROUND, Kind.RECEIVER, Kind.DATA, Kind.BUS)
OF_BYTES = {"wrong bytes", "bytes compared"}
OF_MODELS = {"model age", "model run"}


class DerivedRecords:
    """The derived records of a scene. bytes: compares the bytes that were read; None if no subscriber needs it."""

    def __init__(self, recorder: Recorder) -> None:
        """Create it after all have subscribed, before units are built: some records follow from those of firmware."""
        self._recorder = recorder
        self._named = {kind: recorder.named_things(kind) for kind in KINDS}
        self._transfers: TransferRecords | None = None
        self._ages: AgeRecords | None = None
        self.bytes: ByteRecords | None = None
        if self._named[Kind.DATA] & OF_MODELS:
            recorder.subscribe((Kind.SPAN,), self._age_records())

    def attach(self, scene: Scene) -> None:
        """Listen to a scene whose parts are all there. BadCase where the scene cannot tell what bytes should be."""
        named = self._named
        if named[Kind.DATA]:
            self._attach_data(scene, named[Kind.DATA])
        if named[Kind.TRANSFER]:
            from ..timing.derived.transfer_records import TransferRecords

            self._transfers = TransferRecords(self._recorder)
            scene.on_transfer(self._transfers.transfer)
        if named[Kind.ROUND]:
            from ..timing.derived.round_records import RoundRecords

            RoundRecords(self._recorder, scene.bus.rounds, scene.bus.period)
        if named[Kind.RECEIVER]:
            scene.record_receivers()
        if "stuck" in named[Kind.BUS]:
            scene.watch_for_stuck_lines()

    def finish(self, scene: Scene) -> None:
        """Record what is incomplete at the end of the run."""
        now = scene.kernel.now
        if self._transfers is not None:
            unfinished = None if scene.case.controller is not None else scene.bus.open_transfer
            self._transfers.finish(now, unfinished, scene.bus.held_since)
        if self.bytes is not None:
            self.bytes.finish(now)

    def _age_records(self) -> AgeRecords:
        if self._ages is None:
            from ..timing.derived.age_records import AgeRecords

            self._ages = AgeRecords(self._recorder)
        return self._ages

    def _attach_data(self, scene: Scene, named: set[str]) -> None:
        """Attach the records of data. Origins are attached first, since the others use them."""
        checks_host = scene.case.checks_host
        origins: Origins | None = None
        if "age" in named or (named & OF_BYTES and checks_host):
            from .read_origins import origins_of

            origins = origins_of(scene)
            scene.on_frame(origins.frame)
            scene.on_transfer(origins.transfer)
        if named & OF_BYTES:
            from ..timing.derived.byte_records import ByteRecords

            self.bytes = ByteRecords(self._recorder, origins if checks_host else None)
            scene.on_transfer(self.bytes.transfer)
        if "chip read" in named:
            ages = self._age_records()
            ages.origins = origins if "age" in named else None
            scene.on_frame(ages.frame)
            scene.on_transfer(ages.transfer)
        if "sample" in named:
            from ..timing.derived.error_records import ErrorRecords

            assert scene.host_agent is not None
            errors = ErrorRecords(self._recorder, scene.host_agent.truth_at, scene.host_agent.host.due)
            scene.on_frame(errors.frame)
            scene.on_transfer(errors.transfer)
