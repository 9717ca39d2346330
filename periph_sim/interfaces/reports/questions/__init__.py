"""Verdicts under open questions: a case is run with other answers to the questions on which it depends.

case as it is --touched options--> questions --each other answer alone--> runs --answers that break nothing--> pairs
all runs --> for each budget: it holds, or the answers under which its verdict differs
run of the case as it is, run with such answers --> the first record that differs

Only single answers and the pairs of `explore` are run, so nothing is known about other combinations.

Terms of this package:

question: a point of the chip's behaviour that TI's manuals leave open. An option of the case has its answer.
touched: a run touches a question if it depends on the question's option.
other answer: an answer that differs from that of the case as it is.
"""
