"""
The interpreted form of a kernel: plain Python that gives what machine code gives, to the last bit.

The form is the kernel's source with three changes. Kernels and dispatched functions that the
source calls are interpreted as well. Arithmetic is that of machine code (``arithmetic``). And
every loop checks in each turn whether its thread was interrupted (``interruption``), so that a
time limit or a cancellation ends an interpreted search, which takes far longer than a compiled
one.
"""

import ast
from collections.abc import Callable, Iterator
import copy
from functools import cache
import linecache
import math
import types
from typing import Any, TypeAlias

from hnr_planner.core.kernels import arithmetic
from hnr_planner.core.kernels.interruption import check

#: What the changed source calls, by the names that it has there.
_CALLED = {
    '__check': check,
    '__divide': arithmetic.divide,
    '__floor_divide': arithmetic.floor_divide,
    '__modulo': arithmetic.modulo,
    '__power': arithmetic.power,
    '__square': arithmetic.square,
    '__whole_power': arithmetic.whole_power,
    '__in_place': arithmetic.in_place,
    '__sum': arithmetic.left_sum,
}


def interpreted_form(function: types.FunctionType) -> Callable[..., Any]:
    """
    Return the interpreted form of a kernel, given its Python function.

    If the file of the function was edited since it was imported, or cannot be read, the source is
    not changed: loops then check for no interruption, and arithmetic is Python's.
    """
    code = _changed_code(function)
    scope = dict(function.__globals__)
    for name in _global_names(code):
        if name in scope:
            scope[name] = _interpreted(scope[name])
    scope.update(_CALLED)
    cells = dict(zip(function.__code__.co_freevars, function.__closure__ or (), strict=True))
    closure = tuple(
        types.CellType(_interpreted(cells[name].cell_contents)) for name in code.co_freevars
    )
    return types.FunctionType(code, scope, function.__name__, function.__defaults__, closure)


def _interpreted(value: Any) -> Any:
    """Return what an interpreted form has in the place of a kernel's global: often the same."""
    if value is math:
        return arithmetic.MATH
    # Kernels and dispatched functions have a form; nothing else that is called has one.
    form = getattr(value, 'interpreted_form', None) if callable(value) else None
    return value if form is None else form


def _global_names(code: types.CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _global_names(constant)


# -- the changed source ---------------------------------------------------------------------------


def _changed_code(function: types.FunctionType) -> types.CodeType:
    """Return the code of the changed source; the function's own code if its file has changed."""
    code = function.__code__
    as_written, changed = _codes(code.co_filename)
    key = code.co_name, code.co_firstlineno
    if key not in changed or as_written[key].co_code != code.co_code:
        return code  # the file was edited since it was imported, or there is none
    return changed[key]


_Codes: TypeAlias = dict[tuple[str, int], types.CodeType]


@cache
def _codes(file: str) -> tuple[_Codes, _Codes]:
    """
    Return the code of all functions of ``file``: as it is written, and as ``_Changes`` makes it.

    Keys are the name and first line of a function. The result for a file is cached.
    """
    # All of a file, for what a function is compiled to depends on what its module imports.
    tree = ast.parse(''.join(linecache.getlines(file)))
    as_written = compile(tree, file, 'exec', dont_inherit=True)
    changed = compile(_Changes().visit(tree), file, 'exec', dont_inherit=True)
    return dict(_functions(as_written)), dict(_functions(changed))


def _functions(code: types.CodeType) -> Iterator[tuple[tuple[str, int], types.CodeType]]:
    """Yield ((name, first line), code) of all functions defined in ``code``, nested ones too."""
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield (constant.co_name, constant.co_firstlineno), constant
            yield from _functions(constant)


#: Operators that machine code computes in another way than Python.
_OPERATORS = {
    ast.Div: '__divide',
    ast.FloorDiv: '__floor_divide',
    ast.Mod: '__modulo',
    ast.Pow: '__power',
}


class _Changes(ast.NodeTransformer):
    """Changes to a kernel's source: loops check for interruption; arithmetic is machine code's."""

    def visit_For(self, node: ast.For) -> ast.AST:
        """Insert a check for interruption at the start of each turn of the loop."""
        return self._looking(node)

    def visit_While(self, node: ast.While) -> ast.AST:
        """Insert a check for interruption at the start of each turn of the loop."""
        return self._looking(node)

    def _looking(self, loop: Any) -> ast.AST:
        self.generic_visit(loop)
        loop.body.insert(0, ast.Expr(_call('__check')))
        return _located(loop, loop)

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        """
        Replace an operator in ``_OPERATORS`` by a call.

        A division or modulo by a constant other than 0 stays, since Python agrees there.
        """
        self.generic_visit(node)
        name = _OPERATORS.get(type(node.op))
        constant = node.right.value if isinstance(node.right, ast.Constant) else None
        if name is None or (name != '__power' and constant):
            return node
        call = _call(name, node.left, node.right)
        if name == '__power' and isinstance(constant, int) and constant >= 0:
            call = _call('__whole_power', node.left, node.right)
            if constant == 2:
                call = _call('__square', node.left)
        return _located(call, node)

    def visit_AugAssign(self, node: ast.AugAssign) -> ast.AST:
        """
        Replace an operator in ``_OPERATORS`` by a call that works in place.

        An operation by a constant other than 0 stays. The target is evaluated twice, so that
        kernels must have targets without side effects.
        """
        self.generic_visit(node)
        name = _OPERATORS.get(type(node.op))
        if name is None or (isinstance(node.value, ast.Constant) and node.value.value):
            return node
        old: Any = copy.deepcopy(node.target)
        old.ctx = ast.Load()
        value = _call('__in_place', ast.Name(name, ast.Load()), old, node.value)
        return _located(ast.Assign(targets=[node.target], value=value), node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Replace ``array.sum()`` without arguments by ``left_sum(array)``."""
        self.generic_visit(node)
        method = node.func
        if isinstance(method, ast.Attribute) and method.attr == 'sum':
            if not node.args and not node.keywords:
                return _located(_call('__sum', method.value), node)
        return node


def _located(new: Any, old: ast.AST) -> ast.AST:
    """Return node ``new`` with the line and column of node ``old``, for tracebacks."""
    return ast.fix_missing_locations(ast.copy_location(new, old))


def _call(name: str, *arguments: ast.expr) -> ast.Call:
    return ast.Call(func=ast.Name(name, ast.Load()), args=list(arguments), keywords=[])
