"""Comparison of speed and accuracy: the choices for one scene, with the error and the cost of each.

A row is one choice: a kind of firmware, an arithmetic of the sensor models, or a recording. The first row is the most
accurate one. It is the reference with which the other rows are compared.

rows --> runs --> budgets and values, compared with the most accurate row --> one table, JSON
          '-----> CPU time after the start, repeated -----------------------'
"""
