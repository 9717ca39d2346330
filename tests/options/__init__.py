"""Every option has a short scene that it decides: scripts of firmware and bus go in, records come out."""
