"""Sensor models: motion, arithmetic, noise, identification, extremes."""
