"""The language of budgets: texts go in, events and measures of events come out."""
