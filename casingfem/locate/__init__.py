"""Where is a bolt loose or a mass lost: the few changes that explain frequencies and shapes."""
