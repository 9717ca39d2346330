"""Runs as one HTML file: verdicts, distributions, and a timeline of each budget's worst occurrence.

    Result, Values --+
                     +--case_report--> CaseReport --page--> HTML that needs no network and no other file
    case --windows---+

Equal runs give equal text, except for the wall time in elements of class `wall`.

Terms of this package:

window: the records around an occurrence (`reports.explain.window`).
explanation: the events that led to an occurrence, and the parts of its time (`Chain`).
lane: a row of a timeline with the events of one wire, register, flag or activity.
picture: the part of a window that is visible at first.
values: all measured values of a budget with their instants (`Values`).
worst, least: in a distribution, the largest and the smallest value.
"""
