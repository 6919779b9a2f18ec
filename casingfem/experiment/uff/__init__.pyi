from .read import UniversalFile, read_headers, read_uff
from .set_58 import FunctionHeader

__all__ = [
    "FunctionHeader",
    "UniversalFile",
    "read_headers",
    "read_uff",
]
