"""Parties on the wires other than the units: on an I2C bus (`i2c`), on UART lines (`uart`), and faults (`faults`).

The docstring of `periph_sim.core` defines the terms, such as party, agent and shortcut.
"""
