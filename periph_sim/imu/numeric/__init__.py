"""Arithmetics of firmware and their costs: float64, float32 and Q formats. They are independent of sensors."""
