"""Which poles explain the responses of a band: windows, fits, how many, what each is worth, stability over orders."""
