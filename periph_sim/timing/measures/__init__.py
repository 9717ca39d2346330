"""Measures, one file a family: records and agents' reports go in, values come out."""
