"""Firmware images as programs of a processor: instructions are executed in the cycles that the chip would need.

Terms of this package, in addition to those of `processor` and `processor.c28x`:

examined pass: a pass of a loop that is observed, to find out whether all further passes would have the same result.
clean pass: an examined pass that the next pass must repeat exactly if it reads the same values; `polls` lists the
    conditions.
sleep: time in which the program executes nothing, in IDLE or while the passes of a wait are skipped.
counter: a register or memory word to which each pass of a loop adds the same number (`counting_loop`).
trace: the list of the instructions that one pass of a loop has executed.
unmodelled word: a word outside of RAM and of the modelled modules (`elsewhere`), such as a register of the ADC.
stub: a value that reads of an unmodelled register return; a case sets it.
"""
