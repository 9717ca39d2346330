"""Coarser levels than edges, for what many runs of one scene come to."""
