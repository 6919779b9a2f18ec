"""Whether modes are identified, paired and fitted as the truth has them, and how sure an update is."""
