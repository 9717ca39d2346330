"""Reports of runs: baselines with JUnit XML and annotations, HTML pages, sweeps, profiles and trades."""
