"""The commands of periph-sim, one file each. A command parses arguments, calls the library and prints the result.

Terms of this package:

rows: the decoded events of all buses of a capture, as columns (`traces.decode.event_rows.Rows`).
burst: consecutive frames on a serial line with no long pause between them. On an SPI bus that has no chip select,
    consecutive words.
selection: the words on an SPI bus from one assertion of chip select to its deassertion.
message: the part of an I2C transfer from a START or repeated START to the next condition.
position: a time in a capture, as a whole number of samples or of ticks of its time stamps.
live session: a run in real time, in which other programs drive wires.
mistake: an error that the user's input caused. It is reported as one line, without a traceback.
"""
