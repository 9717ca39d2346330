"""What an image's program did with its time and its lines: a run goes in; a table, a flame graph, lcov come out."""
