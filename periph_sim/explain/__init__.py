"""The worst occurrence of each budget: what happened around it, why it took so long, and its picture.

timing      verdict: which budget, its worst value, when
  |
window      one more run, recorded: all records around that instant        (`windows`)
  |
evidence    the same by subject: phases on the bus, accesses, flags, what the CPU did   (`Evidence`)
  |
bus_chain, host_chain, event_chain   the steps that led there, by measure  (`Chain`)
  |
text_report, picture; reports/html   for people; `Chain` as JSON for programs
"""
