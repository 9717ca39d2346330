"""Sessions in real time. A loop advances the session in steps. A `Door` transfers bytes between session and clients."""
