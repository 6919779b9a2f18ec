"""contact: dynamic unilateral contact on rods, modal bodies and rotating rims."""
