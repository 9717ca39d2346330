"""Controllers, targets and monitors of I2C (`i2c`), senders and readers of UART lines (`uart`), and faults (`faults`).

All of these are parties on the wires. The devices, which use them to send and receive, are in `periph_sim.devices`.

The docstring of `periph_sim.core` defines the general terms, such as party, agent and shortcut. Terms of this package:
controller: an agent that makes I2C transfers.
master: the party that makes a transfer, which is a controller or a unit.
phase: in I2C, the part of a transfer from a START or repeated START to the next one or the STOP (`i2c.transfer.Phase`).
"""
