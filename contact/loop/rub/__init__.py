"""The step loop of a rub: predict, solve, ledger."""
