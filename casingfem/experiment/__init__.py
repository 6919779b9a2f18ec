"""What was measured: frequency tables and their correlation with a model."""
