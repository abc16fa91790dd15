#!/usr/bin/env python3
"""Writes the docstrings of the stub __init__.pyi as C++ constants, so that they are written once.

    docstrings.py STUB HEADER

`def append(self, t): "Append."` in class Producer becomes `doc::Producer_append`, which begins with a signature that
inspect.signature reads.
"""

import ast
import inspect
import sys
from pathlib import Path


def signature(name, function):
    """`append(self, t, timeout=0.0)`, without types."""
    arguments = function.args
    first = len(arguments.args) - len(arguments.defaults)
    parts = []
    for i, argument in enumerate(arguments.args):
        text = argument.arg
        parts.append(text if i < first else f"{text}={ast.unparse(arguments.defaults[i - first])}")
    if arguments.kwonlyargs:
        parts.append("*")
    for argument, default in zip(arguments.kwonlyargs, arguments.kw_defaults):
        parts.append(argument.arg if default is None else f"{argument.arg}={ast.unparse(default)}")
    return f"{name}({', '.join(parts)})\n--\n\n"


def is_property(function):
    return any(getattr(decorator, "id", "") == "property" for decorator in function.decorator_list)


def docstrings(stub):
    """Pairs of a constant's name and its text."""
    for node in stub.body:
        if isinstance(node, ast.FunctionDef):
            yield node.name, signature(node.name, node) + ast.get_docstring(node)
        if not isinstance(node, ast.ClassDef):
            continue
        functions = [part for part in node.body if isinstance(part, ast.FunctionDef)]
        yield node.name, ast.get_docstring(node)
        for part in functions:
            text = "Make it: see the class." if part.name == "__init__" else ast.get_docstring(part)
            if text:
                head = "" if is_property(part) else signature(part.name, part)
                yield f"{node.name}_{part.name.strip('_')}", head + text


def main():
    stub, header = map(Path, sys.argv[1:])
    lines = ["#pragma once", "", "namespace splinecast::python::doc {", ""]
    for name, text in docstrings(ast.parse(stub.read_text(encoding="utf-8"))):
        lines += [f'inline constexpr const char* {name} = R"doc({inspect.cleandoc(text)})doc";', ""]
    header.write_text("\n".join([*lines, "}  // namespace splinecast::python::doc", ""]), encoding="utf-8")


if __name__ == "__main__":
    main()
