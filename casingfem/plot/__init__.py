"""Everything that draws: figures and pages."""
