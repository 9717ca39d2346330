"""Pictures for people: plain lanes, times and words go in, SVG text comes out. It knows no chip, bus or file format."""
