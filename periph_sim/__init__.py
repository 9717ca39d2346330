"""Models of the TMS320F28335's SCI and I2C that run firmware against bus traces and check its timing."""

__version__ = "0.1.0"  # the one place: the wheel's metadata and `periph-sim --version` are read from here
