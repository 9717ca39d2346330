"""The user interfaces: commands, reports and the pytest plugin.

Terms of this package:

case, unit, outside party: see `periph_sim.scene`. A case can list budgets that must break in its key `breaks`.
budget: a limit for a measure, such as the response time of a unit on the bus.
occurrence: one measured value of a budget, or the events that determine it. In the worst occurrence, the value is
    nearest to the limit or farthest beyond it. The least critical occurrence is the opposite.
verdict: the result of a budget in a run: it passes, it is broken, or it is not judged, because too little was measured.
instant of a verdict: the time `Verdict.at_s` of its worst value, or of a fault that breaks the budget. A value of a
    whole run, such as a sum, may have no instant.
record: an event of a run that was stored, such as an edge on a wire or an access to a register.
option: the choice of one behaviour where TI's manuals leave the behaviour of the chip open.
chain: the events around an occurrence, as lines of text in a baseline (`reports.baselines.event_chain`), or with their
    causes in an explanation (`reports.explain.chain`).
row: in `trade`, one choice between speed and accuracy; in a sweep, the result of one run.
coverage: the runs of a case at many phases (`periph-sim prove`). A coverage file stores their worst values.
phase, window: in a coverage, the time at which a frame, round or send starts, and a range of such phases at which the
    same budget is broken. In an explanation, a part of an I2C transfer, and the records around an occurrence.
"""
