"""Timing diagrams as SVG or text, from lanes of plain data; independent of chips, buses and file formats."""
