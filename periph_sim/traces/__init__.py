"""Captures: formats, decoders, compliance, comparison, drawing. The decoders share no code with chips or agents."""
