"""Edges of a capture to the events of a protocol, one file a protocol."""
