"""Time records of modal tests, and the frequency responses estimated from them."""
