"""Many runs from one scene file: plan, run, keep, tabulate."""
