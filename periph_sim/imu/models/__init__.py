"""Models of gyroscope, accelerometer and magnetometer for any arithmetic: equations and named parameters."""
