"""Whether structures and simple contacts give what is published, exact or computed independently."""
