"""The commands of periph-sim, one file each. A command parses arguments, calls the library and prints the result."""
