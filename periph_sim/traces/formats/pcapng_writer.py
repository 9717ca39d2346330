"""Writer of pcapng, the file format of Wireshark: converts packets with times to blocks of bytes.

    section | one interface per bus | packet, packet, ...

Only three types of blocks and three types of options are used, so no library is needed.

Source: IETF draft-ietf-opsawg-pcapng; LINKTYPE_I2C_LINUX (209) and LINKTYPE_USER0 (147) of the list of link types at
tcpdump.org.
"""

from __future__ import annotations

from struct import pack

# Link type of I2C messages. A packet has a bus number, flags as in struct i2c_msg of Linux, and the bytes on the wire.
I2C_LINUX = 209
USER0 = 147  # link type whose content is defined by its users; here, a packet has the bytes of a serial line
READ, TEN_BITS = 0x0001, 0x0010  # flags of an I2C message: R/W = 1, and a 10-bit address

COMMENT, IF_NAME, IF_TSRESOL, END = 1, 2, 9, 0


def section() -> bytes:
    """Return the section block, which is the header of a file."""
    return _block(0x0A0D0D0A, pack("<IHHq", 0x1A2B3C4D, 1, 0, -1))


def interface(link_type: int, name: str, decimals: int) -> bytes:
    """Return an interface block. Interfaces are numbered from 0 in the order of their blocks.

    link_type: I2C_LINUX or USER0.
    decimals: the number of decimals of a second in the times of the interface's packets.
    """
    options = _option(IF_NAME, name.encode()) + _option(IF_TSRESOL, bytes([decimals])) + _option(END, b"")
    return _block(1, pack("<HHI", link_type, 0, 0) + options)


def packet(number: int, time: int, content: bytes, comment: str) -> bytes:
    """Return a packet block.

    number: the number of the interface.
    time: the time in units of the last decimal of the interface (see `interface`).
    content: the bytes of the packet in the form that the link type of the interface defines.
    comment: a text that Wireshark shows as the comment of the packet.
    """
    size = len(content)
    head = pack("<IIIII", number, time >> 32, time & 0xFFFFFFFF, size, size)
    return _block(6, head + _padded(content) + _option(COMMENT, comment.encode()) + _option(END, b""))


def i2c_content(bus: int, flags: int, on_the_wire: bytes) -> bytes:
    """Return the content of a packet of link type I2C_LINUX.

    bus: the number of the bus, of which only the lower seven bits are used.
    flags: the sum of READ and TEN_BITS, as far as they apply.
    on_the_wire: all bytes of the message, including the address.
    """
    return pack(">BI", bus & 0x7F, flags) + on_the_wire


def _block(kind: int, body: bytes) -> bytes:
    length = len(body) + 12
    return pack("<II", kind, length) + body + pack("<I", length)


def _option(code: int, value: bytes) -> bytes:
    return pack("<HH", code, len(value)) + _padded(value)


def _padded(content: bytes) -> bytes:
    return content + bytes(-len(content) % 4)
