"""The measures: quantities that budgets limit. Each file contains related measures."""
