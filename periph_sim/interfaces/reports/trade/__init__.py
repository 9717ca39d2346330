"""Comparison of speed and accuracy: the choices for one scene, with the error and the cost of each.

A row is one choice: a kind of firmware, an arithmetic of the sensor models, or a recording.

rows --> runs --> budgets and values, compared with the most accurate row --> one table, JSON
          '-----> CPU time after the start, repeated -----------------------'
"""
