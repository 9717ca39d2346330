"""State of a scene: a snapshot of the states of its parts by name. It can be restored in a scene of the same case.

    Scene --modules_of--> {"dsp.SCI-A": socket, "SDA": wire, ...} --take--> Snapshot --restore--> Scene

A snapshot does not contain measures, nor attributes that only reports read. Python firmware and C sources keep part of
their state on a stack, which cannot be restored. A scene with such a unit is therefore run up to the time of the
snapshot, and its state is then compared with the snapshot. This run begins at the start of the scene, or at a
checkpoint if C sources keep logs of their accesses. A checkpoint is an earlier snapshot with these logs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from .. import __version__
from ..core.records import RECORDED, Recorder
from ..core.restore import NotRestorable, restore
from ..core.sampler import Sampler
from ..core.snapshot import Foreign, Keyed, Module, Snapshot, absolute, take_snapshot
from ..processor.c28x.execution.cpu import Operation
from ..processor.image.program import ImageProgram
from ..processor.operand import Operand

if TYPE_CHECKING:
    from ..processor.dsp import Dsp
    from ..processor.host_code.firmware import HostFirmware
    from ..processor.image.cpu import ImageCpu
    from .scene import Scene

NO_PART = ("name", "about", "duration", "budget", "breaks")  # keys of a case that do not affect the state
DIGEST = 8  # length of a digest, in bytes
WINDOWS = 10_000  # number of windows in a second of simulated time; the checkpoint of a run is in its last window


def state_of_scene(scene: Scene) -> Snapshot:
    """Return the state of a scene that is not running, after pending changes of wires have taken effect."""
    scene.kernel.settle()
    taken = take_snapshot(modules_of(scene), scene.kernel.now, scene.recorder.number, tuple(_identity(scene)))
    return taken._replace(base=scene.checkpoint)


def restore_scene(scene: Scene, snapshot: Snapshot) -> None:
    """Bring a scene that has not run into the state of a snapshot.

    If all units run images, the state is assigned. Otherwise, the scene is run up to the time of the snapshot. If the
    snapshot has a checkpoint and the scene is restorable, C sources are first executed up to the checkpoint with the
    values in the logs of their accesses, and the scene is run only from there.

    Raise NotRestorable, with nothing changed, if the case, a program or the records are not equal, if the scene has run
    already, if a state cannot be assigned, or if the accesses of C sources differ from those in their logs. Raise
    NotRestorable also if the state after the run differs from the snapshot.
    """
    if scene.kernel.events or scene.kernel.now != scene.start:
        raise NotRestorable("the scene has run already; restore the snapshot into one that has just been built")
    for (what, there), (_, here) in zip(snapshot.identity, _identity(scene), strict=False):
        if there != here:
            raise NotRestorable(_mismatch(what, there, here))
    if all(isinstance(dsp.program, ImageProgram) for dsp in scene.units.values()):
        scene.kernel.settle()
        restore(snapshot, modules_of(scene))
        return
    if scene.keeps_logs and snapshot.base is not None:
        _restore_checkpoint(scene, snapshot.base)
    scene.advance(snapshot.tick)
    for place, (before, now) in snapshot.differences(state_of_scene(scene)).items():
        at = scene.timebase.show(snapshot.tick - scene.start)
        raise NotRestorable(
            f"the scene was run to {at}, where {place} is {now} instead of {before}; its firmware or a device depends "
            "on more than the case, or the snapshot was changed"
        )


def modules_of(scene: Scene) -> dict[str, Module]:
    """Return a dictionary from names to the parts of a scene that have a state, as their attribute `STATE` declares.

    The states of the parts are collected and restored in the order of the dictionary. If a part has the name of an
    earlier part, its name gets an apostrophe.
    """
    samplers = _samplers(scene)
    keys: dict[type, Keyed] = {Sampler: Keyed(lambda sampler: (sampler.rank,), samplers.__getitem__)}
    parts: list[tuple[str, object]] = []
    if scene.head is not None:
        parts += [("controller", scene.head.controller), ("head", scene.head)]
    if scene.host is not None:
        parts.append(("host", scene.host))
    parts += [*scene.chips.items(), *scene.devices.items()]
    parts += [(f"fault {number}", fault) for number, fault in enumerate(scene.faults)]
    parts += [(f"sampler {rank}", sampler) for rank, sampler in sorted(samplers.items())]
    modules = [("records", Module(scene.recorder))]
    for name, dsp in scene.units.items():
        modules += _unit_modules(name, dsp, dsp.clock.cycle_at(scene.kernel.now), keys).items()
    modules += [(name, Module(part, keys=keys)) for name, part in (*parts, *scene.wires.items())]
    # The kernel is last, because its events are identified by attributes of the modules before it.
    modules.append(("kernel", Module(scene.kernel, keys=keys)))
    found: dict[str, Module] = {}
    for name, module in modules:
        while name in found:
            name += "'"
        found[name] = module
    return found


def _unit_modules(name: str, dsp: Dsp, cycle: int, keys: Mapping[type, Keyed]) -> dict[str, Module]:
    parts: dict[str, object] = {name: dsp, f"{name}.clock": dsp.clock, f"{name}.processor": dsp.processor}
    if dsp.router is not None:
        parts[f"{name}.router"] = dsp.router
    parts[f"{name}.program"] = program = dsp.program
    if dsp.sources is not None:
        parts[f"{name}.sources"] = dsp.sources
    parts |= {f"{name}.{module}": socket for module, socket in dsp.sockets.items()}
    keys = {**keys, Operand: Keyed(lambda one: (one.address, one.words, one.named), dsp.processor.bus.named)}
    if isinstance(program, ImageProgram):
        keys[Operation] = Keyed(partial(_operation_key, program.cpu), program.cpu.operation_of)
    return {part: Module(target, cycle, keys) for part, target in parts.items()}


def _samplers(scene: Scene) -> dict[int, Sampler]:
    """Return the samplers, which pass settled levels of wires to parties, by rank.

    The rank is the place of a sampler in the order in which samplers are notified. All scenes of a case make their
    samplers in the same order, so a rank identifies a sampler in a saved state.
    """
    found = [listener for wire in scene.wires.values() for listener in wire.listeners()]
    for dsp in scene.units.values():
        found += [socket.inputs for socket in dsp.sockets.values()]
        if dsp.router is not None:
            found.append(dsp.router.pads)
    return {one.rank: one for one in found if isinstance(one, Sampler)}


# Checkpoints of C sources -----------------------------------------------------


def keep_logs(scene: Scene) -> bool:
    """Make all C sources of a scene log their accesses, and return True.

    If a unit of the scene runs Python firmware, or no unit runs C sources, do nothing and return False.
    """
    from ..processor.host_code.access_log import LoggedRun

    if not all(dsp.sources is not None or isinstance(dsp.program, ImageProgram) for dsp in scene.units.values()):
        return False
    sources = _sources_of(scene)
    for one in sources.values():
        one.make_run = LoggedRun
    return bool(sources)


def run_to_checkpoint(scene: Scene, until: int) -> None:
    """Run to the first instant in the last window before `until` at which the access logs of all C sources can end.

    A log can end while `main` computes, the CPU sleeps and no service routine is active. WINDOWS determines the length
    of the window. If all parts of the state at this instant can be restored, the state becomes the scene's checkpoint.
    If there is no such instant, the scene runs up to `until`, and its checkpoint does not change.
    """
    from ..processor.host_code.access_log import log_at_rest

    sources = _sources_of(scene)
    at = max(scene.kernel.now, until - scene.timebase.per_second // WINDOWS)
    while at <= until:
        scene.kernel.run_until(at)
        logs = {name: log for name, one in sources.items() if (log := log_at_rest(one)) is not None}
        if logs.keys() == sources.keys():
            state = state_of_scene(scene)
            if _is_whole(state):
                scene.checkpoint = state._replace(logs=logs, base=None)
            return
        at = scene.kernel.next_time()


def _restore_checkpoint(scene: Scene, checkpoint: Snapshot) -> None:
    """Restore a checkpoint. Do nothing if the scene has a part that cannot be restored.

    Raise NotRestorable, with nothing changed, if the accesses of C sources differ from those in their logs.
    """
    from ..processor.host_code.access_log import re_execute, restart

    fresh, sources = state_of_scene(scene), _sources_of(scene)
    if not _is_whole(fresh):
        return
    try:
        for name, one in sources.items():
            time, now = f"{name}.processor.time", checkpoint.cycles[f"{name}.processor"]
            cycle, until = (absolute(checkpoint.values[f"{time}.{instant}"], now) for instant in ("cycle", "_until"))
            re_execute(one, checkpoint.logs[name], (cycle, until - cycle))
        restore(checkpoint, modules_of(scene))
        scene.checkpoint = checkpoint
    except NotRestorable:
        for one in sources.values():
            restart(one)
        restore(fresh, modules_of(scene))
        raise


def _sources_of(scene: Scene) -> dict[str, HostFirmware]:
    return {name: dsp.sources for name, dsp in scene.units.items() if dsp.sources is not None}


def _is_whole(state: Snapshot) -> bool:
    """Return True if all parts of a state can be restored."""
    return not any(isinstance(value, Foreign) for value in state.values.values())


# Keys by which `restore` finds objects ---------------------------------------


def _operation_key(cpu: ImageCpu, operation: Operation) -> tuple[object, ...] | None:
    at = operation.address
    return (at, cpu.word_at(at), cpu.word_at(at + 1)) if operation.place == at else None


# Identity of a snapshot -----------------------------------------------------------


def _identity(scene: Scene) -> Iterator[tuple[str, str]]:
    yield "version", __version__
    yield "case", scene.case.name
    for key in scene.case.__struct_fields__:
        if not key.startswith("_") and key not in NO_PART:
            yield f"[{key}]", _digest(repr(getattr(scene.case, key)).encode())
    for name, dsp in scene.units.items():
        if isinstance(dsp.program, ImageProgram):
            image = dsp.program.image
            words = [(section.address, section.run, list(section.words)) for section in image.sections]
            program = _digest(msgspec.json.encode((words, image.initial)))
        elif dsp.sources is not None:
            program = _digest(dsp.sources.contents)
        else:
            program = _digest(_bytes_of(Path(scene.firmware[name].main.__code__.co_filename)))
        yield f"program in unit {name}", program
    yield "choice of records", _digest(repr(list(_recorded(scene.recorder))).encode())


def _recorded(recorder: Recorder) -> Iterator[object]:
    """Yield, for each kind of records, its name, whether it is recorded, and the recorded subjects (None: all).

    Modules keep additional state for records, so snapshots are equal only if the same records are made.
    """
    for kind in RECORDED:
        subjects = recorder.subjects(kind)
        yield kind.value, recorder.wants(kind), subjects if subjects is None else sorted(subjects)


def _bytes_of(source: Path) -> bytes:
    """Return the present contents of a source file; b"" if it cannot be read."""
    try:
        return source.read_bytes()
    except OSError:
        return b""


def _digest(data: bytes) -> str:
    return blake2b(data, digest_size=DIGEST).hexdigest()


def _mismatch(what: str, there: str, here: str) -> str:
    if what == "version":
        return f"the snapshot is of version {there} of periph_sim, and this is version {here}"
    if what == "case":
        return f"the snapshot is of case {there!r}, and the scene is of case {here!r}"
    return f"the snapshot was taken of a scene with another {what}"
