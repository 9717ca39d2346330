"""Timing diagrams as SVG or text, from plain lanes, times and words; independent of chips, buses and file formats."""
