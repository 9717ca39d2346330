"""The language of budgets: the syntax of events and measures in the text of a case, and its parser."""
