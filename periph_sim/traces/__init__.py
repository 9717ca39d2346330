"""Captures: file formats, decoders, compliance checks, comparison and drawing.

The decoders share no code with the chips or the agents.
"""
