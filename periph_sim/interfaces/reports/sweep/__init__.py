"""Sweeps: run one case many times with different values; one column per figure.

case, {key: values} --plan--> changes of each run --workers--> Row each --columns--> Sweep

Rows are in the order of the changes, for any number of workers.
"""
