"""The I2C module (SPRUG03B), a file a chapter."""
