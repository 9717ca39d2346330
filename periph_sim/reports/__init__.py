"""Reports of runs: baselines with JUnit XML and annotations, and HTML pages."""
