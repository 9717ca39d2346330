"""`--fidelity auto`: the cheapest level whose errors, measured on the first part of a scene, are within a bound."""
