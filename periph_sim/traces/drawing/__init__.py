"""Timing diagrams as SVG or text. Their input is plain data: lanes, which are the rows of a diagram.

Only `capture_lanes` depends on captures and decoders.
"""
