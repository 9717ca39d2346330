"""Who talks to the SCIs of a scene from outside: the tables [[serial.send]] and [[serial.expect]] at work."""
