"""Parties on SCL and SDA other than the units: controllers, targets, monitors."""
