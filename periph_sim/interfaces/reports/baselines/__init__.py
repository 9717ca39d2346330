"""Baselines: the exact figures of cases, kept in files beside them, compared with a run.

case files --> check --> a CaseCheck for each: equal, changed (with the reason), missing or written; findings
                         --> table, JSON, JUnit XML, annotations
"""
