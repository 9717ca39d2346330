"""The dissertation's experiments at rest, repeated on the models and compared with the published results."""
