"""A session in real time: a loop steps it by a clock, and doors transfer bytes between the steps."""
