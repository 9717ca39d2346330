"""One file for each command, which takes parsed arguments, calls the library, and prints."""
