"""Many runs from one scene file: plan, run, store, tabulate."""
