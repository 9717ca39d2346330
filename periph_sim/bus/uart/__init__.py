"""Parties on a UART line other than the units: senders, readers, monitors, and RS-485 transceivers."""
