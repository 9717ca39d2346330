"""Kinds of arithmetic in which firmware calculates, and their costs: float64, float32 and Q formats."""
