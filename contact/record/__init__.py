"""What a run stores: samples, sums, the ledger of its energy, what a coating lost."""
