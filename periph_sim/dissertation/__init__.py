"""The dissertation's experiments, repeated on the models and compared with the published results."""
