"""Maximum distance between the read and the write of one read-modify-write, in a recording and during a run."""

MODIFY = 4  # maximum cycles between read and write of one read-modify-write
OVERTAKEN = 3  # the write is one of this number of accesses that follow its read
