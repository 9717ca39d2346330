"""Parties on a UART line other than the units: senders and monitors."""
