"""Which small faults a file can have: one changed operator, comparison, condition, call, returned value, minimum or maximum.

Python and the page's JavaScript have the same ones. Annotations, decorators, errors that are raised and text are left alone.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tree_sitter_javascript
from tree_sitter import Language, Node, Parser

OTHER: dict[type[ast.AST], tuple[type[ast.AST], ...]] = {
    ast.Add: (ast.Sub,), ast.Sub: (ast.Add,), ast.Mult: (ast.Div,), ast.Div: (ast.Mult,), ast.FloorDiv: (ast.Mult,),
    ast.Mod: (ast.FloorDiv,), ast.Pow: (ast.Mult,), ast.Lt: (ast.LtE, ast.GtE), ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE), ast.GtE: (ast.Gt, ast.Lt), ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,),
    ast.And: (ast.Or,), ast.Or: (ast.And,), ast.Is: (ast.IsNot,), ast.IsNot: (ast.Is,), ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}  # fmt: skip
OTHER_ON_THE_PAGE = {
    "+": "-", "-": "+", "*": "/", "/": "*", "%": "*", "<": ">=", "<=": ">", ">": "<=", ">=": "<", "===": "!==", "!==": "===",
    "&&": "||", "||": "&&", "??": "&&",
}  # fmt: skip
SWAPPED = {"min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum"}
JAVASCRIPT = Parser(Language(tree_sitter_javascript.language()))


@dataclass(frozen=True)
class Mutant:
    """A fault: these bytes of this file are others."""

    file: str
    line: int
    start: int
    end: int
    before: str
    after: str


def mutants_of(root: Path, file: Path) -> Iterator[Mutant]:
    """Every mutant of one file."""
    source, name = file.read_bytes(), str(file.relative_to(root))
    faults = _in_page(JAVASCRIPT.parse(source).root_node) if file.suffix == ".js" else _in_python(source)
    for line, start, end, after in faults:
        yield Mutant(name, line, start, end, source[start:end].decode(), after)


_Fault = tuple[int, int, int, str]  # line, first byte, byte behind the last, what stands there instead


def _in_python(source: bytes) -> Iterator[_Fault]:
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    for node, changed in _changes(ast.parse(source)):
        assert isinstance(node, ast.expr | ast.stmt)
        start = starts[node.lineno - 1] + node.col_offset
        end = starts[(node.end_lineno or 0) - 1] + (node.end_col_offset or 0)
        after = ast.unparse(changed)
        yield node.lineno, start, end, after if isinstance(node, ast.stmt) else f"({after})"


def _changes(tree: ast.AST) -> Iterator[tuple[ast.AST, ast.AST]]:
    """Nodes of the syntax tree, and what each is changed to."""
    for node in _reached(tree):
        match node:
            case ast.BinOp() | ast.AugAssign() | ast.BoolOp():
                yield from ((node, _with(node, op=other())) for other in OTHER.get(type(node.op), ()))
            case ast.Compare(ops=[op]):
                yield from ((node, _with(node, ops=[other()])) for other in OTHER.get(type(op), ()))
            case ast.Call(func=ast.Name(id=name) | ast.Attribute(value=ast.Name(id="np"), attr=name)) if (
                name in SWAPPED
            ):
                function = ast.unparse(node.func).replace(name, SWAPPED[name])
                yield node, _with(node, func=ast.parse(function, mode="eval").body)
            case ast.Expr(value=ast.Call()):
                yield node, ast.Pass()
            case ast.Return(value=ast.expr() as value) if not isinstance(value, ast.Constant):
                yield node, ast.Return(ast.Constant(None))
            case ast.If(test=test) | ast.IfExp(test=test) | ast.While(test=test) if not _has_its_own(test):
                yield test, test.operand if isinstance(test, ast.UnaryOp) else ast.UnaryOp(ast.Not(), test)
            case _:
                pass


def _has_its_own(test: ast.expr) -> bool:
    """Whether a condition is changed as a comparison or as and and or, or is one of the type checker's."""
    return isinstance(test, ast.Compare | ast.BoolOp) or ast.unparse(test) == "TYPE_CHECKING"


def _reached(tree: ast.AST) -> Iterator[ast.AST]:
    for field, value in ast.iter_fields(tree):
        if field in ("annotation", "returns", "decorator_list"):
            continue
        part: list[Any] | ast.AST | str | None = value
        for node in part if isinstance(part, list) else [part]:
            if isinstance(node, ast.AST) and not isinstance(node, ast.Raise | ast.JoinedStr):
                yield node
                yield from _reached(node)


def _with(node: ast.AST, **changed: object) -> ast.AST:
    return type(node)(**{**dict(ast.iter_fields(node)), **changed})


def _in_page(node: Node) -> Iterator[_Fault]:
    if node.type in ("throw_statement", "template_string", "import_statement"):
        return
    changed = _change_in_page(node)
    if changed is not None:
        at, after = changed
        yield at.start_point.row + 1, at.start_byte, at.end_byte, after
    for child in node.children:
        yield from _in_page(child)


def _change_in_page(node: Node) -> tuple[Node, str] | None:
    """A node and what stands there instead. None: nothing is changed here."""
    match node.type:
        case "binary_expression":
            operator = node.child_by_field_name("operator")
            other = OTHER_ON_THE_PAGE.get(_text(operator)) if operator else None
            return (operator, other) if operator and other else None
        case "call_expression":
            function = node.child_by_field_name("function")
            if function and _text(function) in ("Math.min", "Math.max"):
                return function, "Math.max" if _text(function) == "Math.min" else "Math.min"
        case "expression_statement" if node.children[0].type == "call_expression":
            return node, ";"
        case "return_statement" if node.named_child_count:
            return node, "return undefined;"
        case "if_statement" | "ternary_expression":
            test = node.child_by_field_name("condition")
            if test and not any(child.type == "binary_expression" for child in (test, *test.named_children)):
                return test, f"(!{_text(test)})" if test.type == "parenthesized_expression" else f"!({_text(test)})"
        case _:
            pass
    return None


def _text(node: Node) -> str:
    return (node.text or b"").decode()
