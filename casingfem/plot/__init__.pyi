from .page import Picture, Section, Table, Verdict, render_page

__all__ = [
    "Picture",
    "Section",
    "Table",
    "Verdict",
    "render_page",
]
