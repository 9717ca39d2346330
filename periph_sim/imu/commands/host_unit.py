"""`periph-sim host-unit PORT`: sends the frames of a flight or of UDP datagrams to a serial port, as the host does."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ...interfaces.commands.command_frame import address_given, command, time_given

if TYPE_CHECKING:
    from ..host_frame import Encoding


WAITS = 5  # maximum time in seconds that a port may take to accept bytes


@command(
    "run",
    "periph-sim host-unit /tmp/dsp --flight flight.csv",
    "periph-sim host-unit rfc2217://127.0.0.1:4000 --udp 9000",
    former={"--encoding": "--host-encoding"},
)
@click.argument("port")
@click.option("--flight", type=click.Path(path_type=Path), metavar="CSV", help="Send a recorded flight, once.")
@click.option("--udp", metavar="[ADDRESS:]PORT", help="Send the latest values of datagrams, as sent by Simulink.")
@click.option(
    "--udp-order", type=click.Choice(["little", "big"]), default="little", help="Byte order of --udp.  [little]"
)
@click.option("--baud", default=115_200, show_default=True, type=click.IntRange(min=1), help="Rate of PORT.")
@click.option("--period", default="20 ms", show_default=True, metavar="TIME", help="From one frame to the next.")
@click.option("--host-encoding", "settings", multiple=True, metavar="KEY=VALUE", help="A key of [host.encoding].")
@click.option("--frames", type=click.IntRange(min=0), metavar="N", help="End after N frames; else with Ctrl-C.")
def host_unit(
    port: str,
    flight: Path | None,
    udp: str | None,
    udp_order: str,
    baud: int,
    period: str,
    settings: tuple[str, ...],
    frames: int | None,
) -> None:
    """Send frames of 12 bytes to PORT, 50 a second, like the [host] of a case.

    PORT is a port that pyserial can open (extra live): /dev/ttyUSB0, the pseudo-terminal of `serve`,
    rfc2217://127.0.0.1:4000, f28335://CASE.toml?port=scia. A flight is a CSV file with columns time, phi, theta, psi,
    ax, ay, az and their units. A datagram holds phi, theta, psi, ax, ay, az as doubles or singles, in rad and g, or a
    whole frame.
    """
    try:
        import serial

        from ...outside.live.pyserial_urls import register
    except ImportError:
        raise click.ClickException("the host unit needs pyserial: pip install 'periph-sim[live]'") from None
    from ...outside.live.loop import signals_calling
    from ..host_frames import FRAME_BYTES
    from ..host_unit import FlightFrames, UdpFrames, pacer_for, send_frames

    if (flight is None) == (udp is None):
        raise click.UsageError("give either --flight or --udp as the source of values")
    every = time_given("--period", period)
    if not every:
        raise click.UsageError("--period 0 s: expected more than 0")
    register()
    asked: list[int] = []
    with _mistakes(port), signals_calling(lambda number, _: asked.append(number)):
        encoding = _encoding(settings)
        source: FlightFrames | UdpFrames
        if udp is not None:
            address, number = address_given("--udp", udp)
            source = UdpFrames(address, number, encoding, udp_order, lambda line: click.echo(line, err=True))
            click.echo(f"values are read from UDP port {source.port} of {address}", err=True)
        else:
            assert flight is not None
            source = FlightFrames(flight, encoding, every)
        with _opened(serial, port, baud) as line:
            pacer = pacer_for(line)
            sent = send_frames(line, source, every, pacer, frames, lambda: bool(asked))
    click.echo(f"{sent.frames} frames, {sent.frames * FRAME_BYTES} bytes sent to {port}, {sent.came} received")
    if isinstance(source, UdpFrames):
        source.close()
        click.echo(f"{source.held} frames repeated the values before, {source.refused} datagrams refused")
    click.echo("\n".join(pacer.text()))


def _opened(serial: Any, port: str, baud: int) -> Any:
    try:
        return serial.serial_for_url(port, baud, write_timeout=WAITS)
    except NotImplementedError:  # Ports of rfc2217:// do not support a time limit for writing.
        return serial.serial_for_url(port, baud)


def _encoding(settings: tuple[str, ...]) -> Encoding:
    from ..host_frames import encoding_of

    pairs = [setting.partition("=") for setting in settings]
    for setting, (_, equals, _) in zip(settings, pairs, strict=True):
        if not equals:
            raise click.UsageError(f"--host-encoding {setting!r}: expected key=value, as in phi='0.01 deg'")
    return encoding_of({key.strip(): value.strip() for key, _, value in pairs})


@contextmanager
def _mistakes(port: str) -> Iterator[None]:
    """Convert errors of the port, the file or a setting to a ClickException whose message is one sentence."""
    from serial import SerialException

    from ...outside.live.port_door import in_our_words
    from ...scene.firmware_loader import BadSetting

    try:
        yield
    except BadSetting as error:
        raise click.UsageError(f"--host-encoding {error.name}: {error}") from None
    except SerialException as error:
        raise click.ClickException(in_our_words(port, error)) from None
    except ValueError as error:
        raise click.ClickException(str(error)) from None
