"""Speed against accuracy: one scene at every level goes in; how far each level is off, and what it costs, comes out.

levels --> runs --> moments and values --paired by occurrence--> errors --> table, JSON, plot
             '----> CPU seconds, events, memory ------------------------------'
"""
