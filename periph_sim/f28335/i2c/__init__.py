"""The I2C module (SPRUG03B)."""
