"""The other parties on a UART line: senders and monitors."""
