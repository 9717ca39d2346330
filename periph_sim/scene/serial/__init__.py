"""Outside parties on the lines of a scene's SCIs, from the tables [[serial.send]] and [[serial.expect]]."""
