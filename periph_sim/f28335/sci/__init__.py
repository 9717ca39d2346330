"""The SCI module (SPRUFZ5A)."""
