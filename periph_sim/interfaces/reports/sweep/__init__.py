"""Sweeps: runs of one case with many different values, whose figures are columns of a table.

case, {key: values} --plan--> changes of each run --workers--> Row each --columns--> Sweep

Rows are in the order of the changes, for any number of workers.
"""
