"""Decoders from the edges of a capture to the events of a protocol."""
