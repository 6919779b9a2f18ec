"""casingfem: shell modes with imperfections, model updating and modal reduction."""
