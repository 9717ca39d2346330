"""Largest distance between the read and the write of one statement, in a recording and during a run."""

MODIFY = 4  # maximum cycles between read and write of one read-modify-write
OVERTAKEN = 3  # the write is among this number of accesses after its read
