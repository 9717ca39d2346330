"""I2CSTR of a slave during whole transfers (SPRUG03B Table 10). i2c_transfer.py describes the notation."""

from __future__ import annotations

import pytest

from ..i2c_rig import Rig
from ..i2c_transfer import play, same


@pytest.fixture
def slave() -> Rig:
    return Rig().begin()


@pytest.mark.rule("I2C-195", "I2C-199", "I2C-205", "I2C-220")
def test_a_pointer_is_written_and_two_bytes_are_read(slave: Rig):
    transfer = """
        > bus   S  48W  00   S  48R  11  22N  P
        > read  -  -    DRR  -  -    -   -    -
        > DXR   -  -    -    -  11   22  -    -
        < ack   -  0    .    -  0    -   -    -
        < hold  0  .    .    .  .    .   .    .
        < BB    1  .    .    .  .    .   .    0
        < AAS   0  1    .    0  1    .   0    .
        < SDIR  0  .    .    .  1    .   .    0
        < XRDY  1  .    .    .  .    .   .    .
        < NACK  0  .    .    .  .    .   1    .
        < SCD   0  .    .    .  .    .   .    1
    """
    assert play(transfer, slave) == same(transfer)


@pytest.mark.rule("I2C-210", "I2C-211", "I2C-239", "I2C-240")
def test_a_byte_that_is_not_read_waits_and_the_next_one_holds_scl(slave: Rig):
    transfer = """
        > bus     S  48W  11  22  +    +    33   P
        > read    -  -    -   -   DRR  DRR  DRR  -
        < ack     -  0    .   .   -    -    0    -
        < hold    0  .    .   1   0    .    .    .
        < RRDY    0  .    1   .   .    0    .    .
        < RSFULL  0  .    .   1   0    .    .    .
        < SCD     0  .    .   .   .    .    .    1
    """
    assert play(transfer, slave) == same(transfer)


def test_a_read_holds_scl_until_i2cdxr_is_written(slave: Rig):
    transfer = """
        > bus   S  48R  +   11  +   22N  P
        > DXR   -  -    11  -   22  -    -
        < hold  0  1    0   1   0   .    .
        < XRDY  1  .    .   .   .   .    .
        < XSMT  1  0    1   0   1   .    .
        < NACK  0  .    .   .   .   1    .
    """
    assert play(transfer, slave) == same(transfer)


@pytest.mark.rule("I2C-201", "I2C-204")
def test_nacksnt_of_a_refused_byte_outlasts_the_next_transfer(slave: Rig):
    transfer = """
        > bus      S  48W  11    22   P  S  48W  44   P
        > read     -  -    DRR   DRR  -  -  -    DRR  -
        > MDR      -  -    8020  -    -  -  -    -    -
        < ack      -  0    .     1    -  -  0    .    -
        < AAS      0  1    .     .    0  .  1    .    0
        < NACKSNT  0  .    .     1    .  .  .    .    .
        < SCD      0  .    .     .    1  .  .    .    .
    """
    assert play(transfer, slave) == same(transfer)


@pytest.mark.rule("I2C-198", "I2C-207")
def test_another_slave_a_general_call_and_itself_in_one_transfer(slave: Rig):
    transfer = """
        > bus   S  2AW  11  S  00W  22   S  48R  33N  S  48W  P
        > DXR   -  -    -   -  -    -    -  33   -    -  -    -
        > read  -  -    -   -  -    DRR  -  -    -    -  -    -
        < ack   -  1    .   -  0    .    -  0    -    -  0    -
        < BB    1  .    .   .  .    .    .  .    .    .  .    0
        < AD0   0  .    .   .  1    .    0  .    .    .  .    .
        < AAS   0  .    .   .  1    .    0  1    0    .  1    0
        < SDIR  0  .    .   .  .    .    .  1    .    0  .    .
        < SCD   0  .    .   .  .    .    .  .    .    .  .    1
    """
    assert play(transfer, slave) == same(transfer)
