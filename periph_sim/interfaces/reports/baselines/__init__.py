"""Baselines: the exact figures of cases, which are stored in files beside the cases and compared with runs.

case files --> check --> a CaseCheck for each: equal, changed (with the reason), missing or written; findings
                         --> table, JSON, JUnit XML, annotations
"""
