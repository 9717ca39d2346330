"""The user interfaces: commands, reports and the pytest plugin."""
