"""Parties that talk to the SCIs of a scene from outside: the tables [[serial.send]] and [[serial.expect]]."""
