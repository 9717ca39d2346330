"""Inspection of an image: registers that code accesses, vectors, functions and words that are no instruction."""

from __future__ import annotations

import pytest

from periph_sim.processor.image_files import debug_info
from periph_sim.processor.image_files.debug_info import Function, FunctionMap
from periph_sim.processor.image_files.inspection import Inspection, inspect
from tests.processor.image_files.own_images import CODE, ENTRY, HANDLER, image, text


def of_code(*words: int) -> Inspection:
    return inspect(image(text(words)))


def touched(found: Inspection) -> list[tuple[str, str, int, int]]:
    return [(one.module, one.name, one.reads, one.writes) for one in found.registers]


def test_registers_accessed_by_data_page_with_their_reads_and_writes():
    found = inspect(image())
    assert touched(found) == [("I2C-A", "I2CSTR", 1, 1), ("I2C-A", "I2CMDR", 0, 1)]
    assert found.registers[0].functions == ("_main",)


def test_vectors_with_their_handlers():
    (vector,) = inspect(image()).vectors
    assert (vector.name, vector.address, vector.handler, vector.stored_in) == (
        "I2CINT1A", 0xDB0, "_handler_of_the_transfer", "_main"
    )  # fmt: skip


def test_functions_end_where_the_next_one_begins_and_labels_are_not_functions():
    found = inspect(image())
    assert [(one.name, one.address, one.size) for one in found.functions] == [
        ("_main", ENTRY, len(CODE) - 1),
        ("_handler_of_the_transfer", HANDLER, 1),
    ]
    assert FunctionMap(image()).name_at(HANDLER) == "_handler_of_the_transfer"
    assert FunctionMap(image()).name_at(0x1234) == "0x001234"


def test_a_frame_that_is_not_modelled_is_named_by_module_and_offset():
    """The code is MOVW DP,#0x1C4 (0x7100) and MOV @0x3,#0."""
    found = of_code(0x761F, 0x01C4, 0x2B03, 0x0006)
    assert touched(found) == [("ADC", "+0x03", 0, 1)]


def test_copied_code_is_inspected_at_its_run_address():
    found = inspect(image(text(address=0x320000, run=ENTRY), entry=0x320000))
    assert touched(found) == [("I2C-A", "I2CSTR", 1, 1), ("I2C-A", "I2CMDR", 0, 1)]
    assert found.vectors[0].handler == f"{HANDLER:#08x}"


def test_a_handler_has_the_name_used_in_budgets_and_not_its_symbol(monkeypatch: pytest.MonkeyPatch):
    of_debug_data = Function("on_transfer", HANDLER, 1, ".text", None)
    monkeypatch.setattr(debug_info, "functions_of", lambda image, debug: (of_debug_data,))
    (vector,) = inspect(image()).vectors
    assert vector.handler == "on_transfer"
