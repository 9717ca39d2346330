"""The user interfaces: commands, reports and the pytest plugin.

Terms of this package:

instant of a verdict: the time `Verdict.at_s` of its worst value. Values of a whole run, such as a sum, may have none.
chain: the events around an occurrence, as lines of text in a baseline (`reports.baselines.event_chain`), or with their
    causes in an explanation (`reports.explain.chain`).
row: in `trade`, one choice between speed and accuracy; in a sweep, the result of one run.
"""
