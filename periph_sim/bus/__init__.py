"""Controllers, targets and monitors of I2C (`i2c`), senders and readers of UART lines (`uart`), and faults (`faults`).

All of these are parties on the wires. The devices, which use them to send and receive, are in `periph_sim.devices`.

The docstring of `periph_sim.core` defines the terms, such as party, agent and shortcut.
"""
