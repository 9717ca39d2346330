"""Display of a live session. The session's thread takes snapshots periodically, and other threads display them.

session --Status--> snapshot --Board--> terminal, browser
"""
