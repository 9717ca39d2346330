"""The commands, one file for each. A command receives parsed arguments, calls the library, and prints the result."""
