"""Timing diagrams as SVG or text, from lanes of plain data. Only `capture_lanes` depends on captures and decoders."""
