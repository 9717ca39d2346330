"""Sessions whose simulated time follows real time. A loop advances a session in steps.

Between two steps, the doors of the loop transfer bytes between the session and its clients.
"""
