"""What users see: commands, reports and the pytest plugin."""
