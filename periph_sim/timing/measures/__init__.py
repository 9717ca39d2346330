"""The quantities that budgets limit; each file contains measures of one family."""
