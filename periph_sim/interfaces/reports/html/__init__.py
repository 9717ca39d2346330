"""Runs as one HTML file: verdicts, distributions, and a timeline of each budget's worst occurrence.

    Result, Values --+
                     +--case_report--> CaseReport --page--> HTML that needs no network and no other file
    case --windows---+

Equal runs give equal text, except for the wall time in elements of class `wall`.
"""
