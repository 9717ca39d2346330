"""An interrupt enable that is set while its flag is 1 requests at once; an option is touched when it first matters."""

from __future__ import annotations

import pytest

from tests.f28335.sci_rig import SciRig, frame

GOOD, BREAK = frame(0x4B) + "1", "0" * 25 + "1"


@pytest.mark.rule("SCI-138", "SCI-094", "SYS-097")
@pytest.mark.parametrize(("text", "flag"), [(GOOD, "RXRDY"), (BREAK, "BRKDT")])
def test_rx_bk_int_ena_set_while_its_flag_is_1_requests_once(text: str, flag: str) -> None:
    rig = SciRig(RXBKINTENA=0).with_rxd(text)
    assert (rig.get(flag), rig.count("RXINT")) == (1, 0)
    rig.set(RXBKINTENA=1)
    assert rig.count("RXINT") == 1
    rig.set(RXBKINTENA=1)
    assert rig.count("RXINT") == 1
    rig.set(RXBKINTENA=0)
    rig.set(RXBKINTENA=1)
    assert rig.count("RXINT") == 2


@pytest.mark.rule("SCI-138")
def test_rx_bk_int_ena_set_while_its_flags_are_0_requests_nothing() -> None:
    rig = SciRig(RXBKINTENA=0)
    rig.send_and_read(GOOD)
    rig.set(RXBKINTENA=1)
    assert (rig.get("RXRDY"), rig.count("RXINT")) == (0, 0)


@pytest.mark.rule("SCI-184")
def test_rx_bk_int_ena_set_in_fifo_mode_requests_nothing() -> None:
    rig = SciRig(fifo=True, RXBKINTENA=0).with_rxd(GOOD)
    assert rig.get("RXFFST") == 1
    rig.set(RXBKINTENA=1)
    assert rig.count("RXINT") == 0


@pytest.mark.rule("SCI-140", "SYS-097")
def test_rx_err_int_ena_set_while_rxerror_is_1_requests_once() -> None:
    rig = SciRig(RXERRINTENA=0).with_rxd(frame(0x11, bad="stop") + "1")
    assert (rig.get("RXERROR"), rig.count("RXINT")) == (1, 0)
    rig.set(RXERRINTENA=1)
    rig.set(RXERRINTENA=1)
    assert rig.count("RXINT") == 1


def test_oe_in_fifo_mode_is_touched_from_the_second_unread_word_on() -> None:
    rig = SciRig(fifo=True).with_rxd(GOOD)
    assert "oe_in_fifo_mode" not in rig.chip.touched
    rig.send(GOOD)
    assert rig.chip.touched == {
        "brr_write_effect",
        "idle_before_first_frame",
        "oe_in_fifo_mode",
        "rx_sync_stages",
        "rxrdy_point",
    }
