"""Causes of the value of a field, wire, span or interrupt: the walk back from a record."""
