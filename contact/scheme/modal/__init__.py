"""The exact-modal scheme: points, rims, rubs, patches, many runs at once."""
