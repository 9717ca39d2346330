"""Baselines: the exact figures of cases, kept in files beside them, compared with a run.

case files --> check --> CaseCheck each: equal, changed (with why), missing, written; findings
                         --> table, JSON, JUnit XML, annotations
"""

from __future__ import annotations

from .check import case_files, check
from .compare import Change, compare
from .errors import BadCheck
from .figures import SCHEMA, Baseline, Figures
from .files import path_for, read, text_of
from .judge import CaseCheck, Finding
from .outcome import RejectedCase

__all__ = [
    "SCHEMA",
    "BadCheck",
    "Baseline",
    "CaseCheck",
    "Change",
    "Figures",
    "Finding",
    "RejectedCase",
    "case_files",
    "check",
    "compare",
    "path_for",
    "read",
    "text_of",
]
