"""The SCI module (SPRUFZ5A), a file a chapter."""
