"""Sessions whose simulated time follows real time. A loop advances a session in steps.

A door connects the session with clients, for example by a pseudo-terminal or a TCP port. Between two steps, the doors
transfer bytes between the session and the clients.
"""
