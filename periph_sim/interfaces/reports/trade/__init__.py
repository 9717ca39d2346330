"""Comparison of speed and accuracy: the choices for one scene, with the error and the cost of each.

rows --> runs --> budgets and values, compared with the most accurate row --> one table, JSON
          '-----> CPU time after the start, repeated -----------------------'
"""
