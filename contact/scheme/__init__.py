"""Time schemes, one file each."""
