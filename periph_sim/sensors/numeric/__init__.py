"""The arithmetic that firmware computes in: float64, float32, Q formats, and what each costs. Knows no sensor."""
