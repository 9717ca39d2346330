"""Sensor models of an IMU: motion, arithmetic, noise, identification, extremes, and the dissertation's experiments."""
