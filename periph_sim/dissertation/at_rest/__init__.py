"""The dissertation's experiments, run on the models: what was published goes beside what comes out."""
