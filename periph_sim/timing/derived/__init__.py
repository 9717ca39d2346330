"""Records that follow from others: transfers, rounds and host frames go in; what budgets measure of them comes out."""
