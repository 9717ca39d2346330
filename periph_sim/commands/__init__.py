"""One file a command. Each takes parsed arguments, calls the library, and prints."""
