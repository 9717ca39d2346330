"""One file, one lint: SAYS, and `faults(run, options)`, which yields the accesses at fault (`lint_finding.py`)."""
