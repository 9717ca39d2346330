"""Largest distance between the read and the write of one statement, in a recording and during a run."""

MODIFY = 4  # cycles: most between read and write of one read-modify-write
OVERTAKEN = 3  # accesses: the write is among so many after its read
