"""Many runs in one loop."""
