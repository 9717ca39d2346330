"""The parties of the table [serial], which send to a scene's SCIs ([[serial.send]]) and expect replies from them
([[serial.expect]]).
"""
