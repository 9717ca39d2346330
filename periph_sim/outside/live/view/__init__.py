"""What a live session shows of itself: its own thread makes a snapshot now and then; others print it or serve it.

session --Status--> snapshot --Board--> terminal, browser
"""
