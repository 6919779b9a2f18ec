"""Places in a Python source where small faults can be introduced.

A site is a piece of one line with texts that may replace it. These are not changed: docstrings, messages, annotations,
decorators, imports, output, `__repr__` and its fields, overloads and methods of protocols, which are never run. Also
unchanged are numbers so small that they only keep a quotient or a logarithm finite, multiples of nan and inf, the side
on which a threshold of round-off counts, the -1 that fills an array of indices, and `a * -1.0`, which equals
`a / -1.0`.

A margin of round-off becomes COARSE: a margin two or three times as large is passed by the same computed numbers, since
round-off is far below it and data are far above. The project tests whether an index is negative, never whether it is
-1, so that -2 in its place has no effect; the mutant without the minus remains.
"""

import ast
import re
from collections.abc import Iterable
from dataclasses import dataclass, field

OPERATORS = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "is": "is not", "is not": "is", "in": "not in",
    "not in": "in", "+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "and": "or",
    "or": "and",
}  # fmt: skip
WORDS = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=", ast.Is: "is",
    ast.IsNot: "is not", ast.In: "in", ast.NotIn: "not in", ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/",
    ast.And: "and", ast.Or: "or",
}  # fmt: skip
# "" drops the function and leaves what it is called with
FUNCTIONS = {
    "abs": "", "max": "min", "min": "max", "maximum": "minimum", "minimum": "maximum", "any": "all", "all": "any",
    "argmax": "argmin", "argmin": "argmax", "sin": "cos", "cos": "sin", "floor": "ceil", "ceil": "floor",
}  # fmt: skip
TOLD = {"echo", "print", "warn", "say", "progress"}
SETTINGS = {
    "strict", "stacklevel", "repr", "indent", "encoding", "err", "nl", "check_finite", "overwrite_a", "overwrite_b",
    "optimize",
}  # fmt: skip
TINY = 1e-100
ROUND_OFF = 1e-6  # a computed number hardly ever equals a threshold of this size or less, other than 0
COARSE = 1e-3
ENDLESS = {"nan", "inf"}
RETURNED = {"float": "2.0 * ({})", "int": "({}) + 1", "bool": "not ({})", "Array": "-({})", "FloatArray": "-({})"}


@dataclass(frozen=True, slots=True)
class Site:
    """A piece of a line, numbered from 1, between two columns, and what may be there instead."""

    line: int
    start: int
    end: int
    choices: tuple[str, ...]
    function: str


@dataclass(slots=True)
class Finder(ast.NodeVisitor):
    """Walks a syntax tree and collects the sites of a source."""

    rows: list[str]
    found: list[Site] = field(default_factory=list)
    scope: tuple[str, ...] = ()
    returns: str = ""

    def add(self, line: int, start: int, end: int, *choices: str) -> None:
        """A site between two columns."""
        self.found.append(Site(line, start, end, choices, ".".join(self.scope)))

    def column(self, line: int, offset: int) -> int:
        """Characters before an offset, which the syntax tree has in bytes."""
        return len(self.rows[line - 1].encode()[:offset].decode())

    def replace(self, node: ast.expr | ast.stmt, *choices: str) -> None:
        """A whole node that is in one line; {} is its text."""
        if node.lineno == node.end_lineno and node.end_col_offset is not None:
            start, end = self.column(node.lineno, node.col_offset), self.column(node.lineno, node.end_col_offset)
            text = self.rows[node.lineno - 1][start:end]
            self.add(node.lineno, start, end, *(choice.replace("{}", text) for choice in choices))

    def swap(self, left: ast.expr, right: ast.expr, word: str) -> None:
        """An operator between two operands in one line."""
        if left.end_lineno == right.lineno and left.end_col_offset is not None:
            start, end = self.column(right.lineno, left.end_col_offset), self.column(right.lineno, right.col_offset)
            piece = r"\s+".join(map(re.escape, word.split()))
            match = re.search(piece, self.rows[right.lineno - 1][start:end])
            if match:
                self.add(right.lineno, start + match.start(), start + match.end(), OPERATORS[word])

    def visit_all(self, nodes: Iterable[ast.AST | None]) -> None:
        """Look into several nodes."""
        for node in nodes:
            if node is not None:
                self.visit(node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        """Defaults and body."""
        if node.name == "__repr__" or is_empty(node.body[-1]):
            return
        before, self.scope, self.returns = (self.scope, self.returns), (*self.scope, node.name), ""
        if isinstance(node.returns, ast.Name):
            self.returns = RETURNED.get(node.returns.id, "")
        self.visit_all([*node.args.defaults, *node.args.kw_defaults, *node.body])
        self.scope, self.returns = before

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        """The body."""
        before, self.scope = self.scope, (*self.scope, node.name)
        self.visit_all(node.body)
        self.scope = before

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        """The value."""
        self.visit_all([node.value])

    def visit_Assign(self, node: ast.Assign) -> None:
        """What is stored in a place may be left out; a name would only be missing."""
        if "__all__" in {getattr(target, "id", "") for target in node.targets}:
            return
        if self.scope and all(isinstance(target, ast.Subscript | ast.Attribute) for target in node.targets):
            self.replace(node, "pass")
        self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        """The other operator, or nothing."""
        word = WORDS.get(type(node.op), "") + "="
        if word in OPERATORS:
            self.swap(node.target, node.value, word)
        self.replace(node, "pass")
        self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> None:
        """A call may be left out; docstrings stay."""
        if isinstance(node.value, ast.Call) and self.scope and name_of(node.value.func) not in TOLD:
            self.replace(node, "pass")
        if not isinstance(node.value, ast.Constant):
            self.generic_visit(node)

    def visit_If(self, node: ast.If) -> None:
        """A condition is never met, or always if it guards more than an error."""
        if name_of(node.test) == "TYPE_CHECKING" or not self.scope:
            return
        guard = all(isinstance(statement, ast.Raise) for statement in node.body)
        self.replace(node.test, *(["False"] if guard else ["False", "True"]))
        self.generic_visit(node)

    def visit_IfExp(self, node: ast.IfExp) -> None:
        """One of both values, always."""
        self.replace(node.test, "False", "True")
        self.generic_visit(node)

    def visit_Raise(self, node: ast.Raise) -> None:
        """No error; its message is left alone."""
        self.replace(node, "pass")

    def visit_Return(self, node: ast.Return) -> None:
        """A changed value, by the type that is promised."""
        if node.value is not None and self.returns and name_of(node.value) not in ENDLESS:
            self.replace(node.value, self.returns)
        self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> None:
        """A bound in or out, a relation turned round; which side a threshold of round-off is on shows nowhere."""
        for left, right, operator in zip([node.left, *node.comparators], node.comparators, node.ops, strict=False):
            if not (is_tiny(left, ROUND_OFF) or is_tiny(right, ROUND_OFF)) or isinstance(operator, ast.Eq | ast.NotEq):
                self.swap(left, right, WORDS[type(operator)])
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        """The opposite operation; text is not calculated with, and a tiny number has no side."""
        word = WORDS.get(type(node.op))
        sides = (node.left, node.right)
        inverse = word in ("*", "/") and is_own_inverse(node.right)
        text = any(isinstance(side, ast.JoinedStr) or is_text(side) or is_tiny(side) for side in sides)
        if word and not text and not inverse:
            self.swap(node.left, node.right, word)
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        """The other word, between each two."""
        for left, right in zip(node.values[:-1], node.values[1:], strict=True):
            self.swap(left, right, WORDS[type(node.op)])
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        """No minus, no `not`."""
        if isinstance(node.op, ast.USub | ast.Not) and node.lineno == node.operand.lineno:
            start = self.column(node.lineno, node.col_offset)
            self.add(node.lineno, start, start + (1 if isinstance(node.op, ast.USub) else 4), "")
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        """The opposite function; texts stay."""
        name = name_of(node.func)
        if name in TOLD:
            return
        other = FUNCTIONS.get(name)
        if other == "" and len(node.args) == 1:
            self.replace(node.func, "")
        elif other and node.func.end_lineno is not None and node.func.end_col_offset is not None:
            end = self.column(node.func.end_lineno, node.func.end_col_offset)
            self.add(node.func.end_lineno, end - len(name), end, other)
        # numpy's reshape takes -2 for -1
        arguments = [a for a in node.args if name != "reshape" or not isinstance(a, ast.UnaryOp)]
        if name == "full" and len(arguments) > 1 and ast.unparse(arguments[1]) == "-1":
            start = self.column(arguments[1].lineno, arguments[1].col_offset)
            self.add(arguments[1].lineno, start, start + 1, "")
            del arguments[1]
        self.visit_all([node.func, *arguments, *(k.value for k in node.keywords if k.arg not in SETTINGS)])

    def visit_Constant(self, node: ast.Constant) -> None:
        """Another number."""
        value = node.value
        if isinstance(value, bool):
            self.replace(node, str(not value))
        elif isinstance(value, int):
            self.replace(node, str(value + 1))
        elif isinstance(value, float) and is_tiny(node, ROUND_OFF) and not is_tiny(node):
            self.replace(node, repr(COARSE))
        elif isinstance(value, float) and not is_tiny(node):
            self.replace(node, repr(2.0 * value) if value else "1.0", repr(3.0 * value) if value else "1.0")

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Text stays."""


def name_of(node: ast.expr) -> str:
    """The last part of a dotted name."""
    return node.attr if isinstance(node, ast.Attribute) else getattr(node, "id", "")


def is_empty(node: ast.stmt) -> bool:
    """Whether a body ends with `...` or its docstring, as that of an overload or of a protocol does."""
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def is_text(node: ast.expr) -> bool:
    """Whether a node is text as it is."""
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def is_tiny(node: ast.expr, most: float = TINY) -> bool:
    """Whether a node is a number that only keeps a quotient or a logarithm finite, or one below another size."""
    return isinstance(node, ast.Constant) and isinstance(node.value, float) and 0.0 < abs(node.value) <= most


def is_own_inverse(node: ast.expr) -> bool:
    """Whether a factor is 1, -1, or a row of them: to multiply and to divide by it is the same."""
    if isinstance(node, ast.List | ast.Tuple):
        return all(map(is_own_inverse, node.elts))
    signed = node.operand if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub) else node
    return isinstance(signed, ast.Constant) and isinstance(signed.value, float) and signed.value == 1.0


def sites(text: str) -> list[Site]:
    r"""Where a source can be changed, by line and column.

    >>> [(s.line, s.choices) for s in sites("def f(x):\n    return abs(x) < 2.0\n")]
    [(2, ('',)), (2, ('<=',)), (2, ('4.0', '6.0'))]
    """
    finder = Finder(text.splitlines())
    finder.visit(ast.parse(text))
    return sorted(finder.found, key=lambda site: (site.line, site.start, site.end))
