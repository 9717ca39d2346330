"""Measures, one file for each family."""
