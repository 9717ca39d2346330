"""Captures in memory: the edges of channels, spans in which levels are unknown, sampling grids and windows."""
