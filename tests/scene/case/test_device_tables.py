"""Which bytes a device's stretch or fault strikes: the limits of each key, and keys that do not go together."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.core.convert import BadTable
from periph_sim.scene.case.device_tables import DeviceFault, DeviceTable, StretchTable


@pytest.mark.parametrize(
    ("table", "fits"),
    [
        ({"bytes": [0]}, True),
        ({"bytes": [-1]}, False),
        ({"phases": [1]}, True),
        ({"phases": [0]}, False),
        ({"share": "0 %"}, True),
        ({"share": "100 %"}, True),
        ({"share": "101 %"}, False),
        ({"length": "1 us to 2 us"}, True),
        ({"length": "2 us to 1 us"}, False),
        ({"access": "both"}, False),
    ],
)
def test_which_bytes_a_stretch_strikes(table: dict[str, Any], fits: bool):
    if fits:
        StretchTable.model_validate({"length": "1 us", **table})
        return
    with pytest.raises(BadTable):
        StretchTable.model_validate({"length": "1 us", **table})


def test_a_stretch_may_be_a_length_alone():
    short, whole = ({"model": "m", "stretch": stretch} for stretch in ("1 us", {"length": "1 us"}))
    assert DeviceTable.model_validate(short) == DeviceTable.model_validate(whole)


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ({"kind": "nack", "bytes": [0]}, ""),
        ({"kind": "nack", "bit": 1}, "a fault of kind 'nack' has no bit; leave it out"),
        ({"kind": "nack", "bit": 1, "clocks": 1}, "a fault of kind 'nack' has no bit and no clocks; leave it out"),
        ({"kind": "wrong", "value": 0}, ""),
        ({"kind": "wrong"}, "a wrong byte needs its value, value = 0xFF for instance"),
        ({"kind": "wrong", "value": 1, "access": "write"}, "is about bytes that the device sends, 1 and up of a read"),
        ({"kind": "wrong", "value": 1, "bytes": [1, 0]}, "is about bytes that the device sends, 1 and up of a read"),
        ({"kind": "wrong", "value": 1, "bytes": [1], "access": "read"}, ""),
        ({"kind": "flip"}, ""),
        ({"kind": "flip", "bit": 0}, ""),
        ({"kind": "flip", "bit": 7}, ""),
        ({"kind": "flip", "bit": 8}, "expected 0 to 7"),
        ({"kind": "flip", "bit": -1}, "expected 0 to 7"),
        ({"kind": "flip", "access": "write"}, "is about bytes that the device sends"),
        ({"kind": "nack", "access": "write", "bytes": [0]}, ""),
        ({"kind": "hold", "clocks": 1}, ""),
        ({"kind": "hold", "length": "1 us"}, ""),
        ({"kind": "hold", "clocks": 0}, "clocks"),
        ({"kind": "hold"}, "SDA is held either for a length or for a number of clocks; give one of them"),
        ({"kind": "hold", "clocks": 1, "length": "1 us"}, "SDA is held either for a length or for a number of clocks"),
        ({"kind": "off", "after": "1 ms", "until": "2 ms"}, ""),
        ({"kind": "off", "share": "50 %"}, "a fault of kind 'off' has no share; leave it out"),
        ({"kind": "off", "bytes": [1], "access": "read"}, "a fault of kind 'off' has no access and no bytes"),
        ({"kind": "off", "after": "1 ms", "until": "1 ms"}, "until comes before after, so nothing would happen"),
        ({"kind": "off", "after": "1 ms", "until": "1.001 ms"}, ""),
    ],
)
def test_the_keys_of_a_fault(fault: dict[str, Any], said: str):
    if not said:
        DeviceFault.model_validate(fault)
        return
    with pytest.raises(BadTable) as caught:
        DeviceFault.model_validate(fault)
    assert said in str(caught.value)
