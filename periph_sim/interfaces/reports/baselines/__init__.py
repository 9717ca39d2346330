"""Baselines: the exact figures of cases, which are stored in files beside the cases and compared with runs.

case files --> check --> a CaseCheck for each: equal, changed (with the reason), missing or written; findings
                         --> table, JSON, JUnit XML, annotations

Terms of this package:

figure: a number of a run that a baseline stores exactly, such as the worst value of a budget in ticks.
worst, least: the largest and the smallest value of a budget. `worst` is the largest value even if the smallest one is
    nearer to its limit.
chain: the events around the largest value of a budget, or around its smallest value if the budget has no `max`, as
    lines "TICKS EVENT".
digest: a hash of all events of a run and their times. Runs with the same digest have the same chains.
finding: a reason why the check of a case fails.
outcome: the figures, the verdicts and the other results of a run (`Outcome`).
"""
