"""The exact-modal scheme for points, rims, rubs, patches, and batches of runs."""
