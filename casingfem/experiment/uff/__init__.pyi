from .nodes import Elements, Nodes, TraceLine, Units
from .read import UniversalFile, read_headers, read_uff
from .set_55 import Shape
from .set_58 import Axes, Axis, Channel, Function, FunctionHeader
from .write import write_uff

__all__ = [
    "Axes",
    "Axis",
    "Channel",
    "Elements",
    "Function",
    "FunctionHeader",
    "Nodes",
    "Shape",
    "TraceLine",
    "Units",
    "UniversalFile",
    "read_headers",
    "read_uff",
    "write_uff",
]
