"""Where the mid-surface is: charts, meridians, twisted plates, blades, tapers, axes of rotation."""
