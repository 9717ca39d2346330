"""Sensor chips as I2C targets, and what chips with registers behind a pointer have in common."""
