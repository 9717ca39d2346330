"""There are no circular imports, not even through imports within functions. Imports for annotations do not count."""

from __future__ import annotations

from graphlib import TopologicalSorter

import grimp


def test_there_are_no_circular_imports() -> None:
    graph = grimp.build_graph("periph_sim", exclude_type_checking_imports=True, cache_dir=None)
    imported = {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    assert sum(map(len, imported.values())) > 1000
    TopologicalSorter(imported).prepare()  # CycleError names the modules of a cycle
