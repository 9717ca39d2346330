"""Baselines: the exact figures of cases, kept in files beside them, compared with a run.

case files --> check --> CaseCheck each: equal, changed (with why), missing, written; findings
                         --> table, JSON, JUnit XML, annotations
"""
