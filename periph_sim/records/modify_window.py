"""How far a write may be behind its read for both to be of one statement; in a recording, and while a run goes on."""

MODIFY = 4  # cycles: most between read and write of one read-modify-write
OVERTAKEN = 3  # accesses: the write is among so many behind its read
