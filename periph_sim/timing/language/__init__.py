"""The language of budgets, in which events and measures of events are written."""
