"""`periph-sim convert IN OUT`: convert a capture or a recorded run to another format.

A capture is read again from OUT, if there is a reader for its format, and compared with what was to be written. A note
reports each loss in OUT. Edges that differ are an error.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import zip_longest
from operator import itemgetter
from pathlib import Path

import click

from ...core.input_files import is_same_file
from ...core.phrases import counted, did_you_mean
from ...records.recording import format_of, recording_formats, rewrite
from ...traces import formats
from ...traces.capture.capture import Channel, window_of, with_channels, within
from ...traces.capture.sampling import rate_text, resampled
from ...traces.formats import BadCapture, psr, vcd
from .command_frame import command, rate_given, read_capture
from .shared_options import RATE, SALVAGE


@command(
    "traces",
    "periph-sim convert capture.sr capture.vcd --window '1 ms..5 ms'",
    "periph-sim convert run.psr run.sr --sample '24 MHz' --channels SCL,SDA",
)
@click.argument("given", metavar="IN", type=click.Path(path_type=Path))
@click.argument("out", metavar="OUT", type=click.Path(path_type=Path))
@RATE
@click.option("--sample", metavar="RATE", help="Write what an analyser of this rate would have recorded.")
@click.option("--channels", metavar="A,B,...", help="Only these, in this order; by name or index.")
@click.option("--window", metavar="FROM..TO", help="Only this part: '100 us..1.2 ms', or sample numbers.")
@SALVAGE
def convert(
    given: Path,
    out: Path,
    rate: str | None,
    sample: str | None,
    channels: str | None,
    window: str | None,
    salvage: bool,
) -> int:
    """Write capture IN as OUT; OUT's suffix selects the format.

    For a run recorded as .psr, OUT may also be any format of `run --record`, with all records.
    """
    if is_same_file(given, out):
        raise click.ClickException(f"{out}: IN and OUT are one file; give another name for OUT")
    part = any(option is not None for option in (rate, sample, channels, window)) or salvage
    if format_of(out) and not part and psr.holds_run(given):
        table = psr.read_table(given)
        rewrite(table, out)
        length = table.end / (table.per_second or Fraction(1))
        said, notes = f"{len(table)} records, {float(length):g} s", []
    else:
        _check_suffix(out, part)
        ready = _part(read_capture(given, rate, salvage), channels, window)
        ready = ready if sample is None else resampled(ready, rate_given("--sample", sample))
        ready = formats.ready_for(out, ready)
        notes = [*ready.notes, *formats.write(ready, out), *_not_kept(ready, out)]
        said = _sizes(ready)
    click.echo("\n".join([f"{out}: {said}", *(f"note: {note}" for note in notes)]))
    return 0


def _check_suffix(out: Path, part: bool) -> None:
    name = out.name.casefold()
    able = formats.writers()
    if any(name.endswith(suffix) for suffix in able):
        return
    if format_of(out):
        way_out = "remove the options that select a part" if part else "record one with run --record run.psr"
        raise click.ClickException(f"{out}: this format holds the records of a run, not a capture; {way_out}")
    suffixes = sorted({*able, *recording_formats()})
    raise click.ClickException(f"{out}: nothing is written as {out.suffix!r}; {did_you_mean(out.suffix, suffixes)}")


def _part(capture: formats.Capture, channels: str | None, window: str | None) -> formats.Capture:
    if channels is not None:
        try:
            capture = with_channels(capture, [name.strip() for name in channels.split(",")])
        except LookupError as error:
            raise click.ClickException(str(error.args[0])) from None
    if window is not None:
        try:
            span = window_of(window, capture.rate)
        except ValueError as error:
            raise click.ClickException(f"--window: {error}") from None
        capture = within(capture, span)
    return capture


def _sizes(capture: formats.Capture) -> str:
    edges = sum(len(channel.edges) for channel in capture.channels)
    counts = f"{counted(len(capture.channels), 'channel')}, {counted(edges, 'edge')}"
    if capture.rate is None:
        return f"{counts}, {capture.length} positions"
    kind = "samples" if capture.sampled else "ticks"
    return f"{counts}, {float(capture.length / capture.rate):g} s in {kind} of {rate_text(capture.rate)}"


def _not_kept(ready: formats.Capture, out: Path) -> Iterator[str]:
    """Read OUT again. Yield a sentence if it ends at another position than `ready`. Raise BadCapture if edges differ.

    Yield nothing if there is no reader for the format of OUT.
    """
    if not any(
        out.name.casefold().endswith(suffix) for reader in formats.readers().values() for suffix in reader.SUFFIXES
    ):
        return
    again = formats.read(out, ready.rate)
    for channel, same in zip_longest(*_in_equal_order(ready, again)):
        if channel is None or same is None or _content(same) != _content(channel):
            found = f"other edges of {(channel or same).name} than in {ready.path}"
            raise BadCapture(out, "reading it again", found, "the same", "report this with both files")
    if again.length != ready.length:
        yield f"the end: {again.length} positions instead of {ready.length}"


def _in_equal_order(ready: formats.Capture, again: formats.Capture) -> tuple[list[Channel], list[Channel]]:
    """Return the channels of a capture and of the file in which it was written, both in order of the names in the file.

    Formats with scopes change names and the order of channels. Channels with equal names are in the order of the file.
    If the reader has also changed names, the channels are in order of their levels and edges.
    """
    names = [channel.name for channel in again.channels]
    for own in ([channel.name for channel in ready.channels], vcd.channel_names(ready)):
        if sorted(own) == sorted(names):
            return _sorted_by(own, ready), _sorted_by(names, again)
    return sorted(ready.channels, key=_content), sorted(again.channels, key=_content)


def _sorted_by(names: list[str], capture: formats.Capture) -> list[Channel]:
    return [channel for _, channel in sorted(zip(names, capture.channels, strict=True), key=itemgetter(0))]


def _content(channel: Channel) -> tuple[int, bytes]:
    return channel.initial, channel.edges.tobytes()
