"""Records derived from transfers, rounds and host frames, as values that budgets measure."""
