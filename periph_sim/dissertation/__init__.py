"""The dissertation's experiments again: what was published goes beside what comes out."""
