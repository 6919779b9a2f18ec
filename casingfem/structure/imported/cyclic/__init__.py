"""How does one sector of a mesh become a wheel? Its two faces paired, its matrices by nodal diameter."""
