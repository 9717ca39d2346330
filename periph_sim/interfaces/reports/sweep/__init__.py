"""Sweeps: runs of one case with many different values. The figures of the runs are columns of a table.

case, {key: values} --plan--> changes of each run --workers--> a Row for each run --columns--> Sweep

A row is the result of one run, or the reason why the run could not be made. The order of the rows is that of the
changes, and does not depend on the number of workers.
"""
