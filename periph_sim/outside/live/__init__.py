"""Sessions in real time. A loop steps the session by a clock; its doors, the connections to clients, transfer bytes."""
