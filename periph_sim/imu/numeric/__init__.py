"""Arithmetics of firmware: float64, float32, Q formats, and their costs. Independent of sensors."""
