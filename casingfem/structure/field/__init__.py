"""How radius, thickness and stiffness vary: Fourier series, random fields, surveys."""
