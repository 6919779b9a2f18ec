"""What the site needs beyond Sphinx: pages of the API, formulas without a network, links that leave docs/."""
