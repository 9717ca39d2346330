"""Speed against accuracy: what a user can choose for one scene, how far each choice is off, and what it costs.

rows --> runs --> budgets and values, against the most accurate row --> one table, JSON
          '-----> CPU time behind the start, repeated -----------------'
"""
