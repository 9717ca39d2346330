"""The display of a live session: its own thread takes snapshots periodically; others print or serve them.

session --Status--> snapshot --Board--> terminal, browser
"""
