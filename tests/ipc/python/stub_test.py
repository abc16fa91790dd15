"""The stub, the docstrings and the program of the package."""

import ast
import inspect
import os
import subprocess
import sys
import unittest
from pathlib import Path

import splinecast

STUB = Path(splinecast.__file__).with_name("__init__.pyi")


def stubbed():
    """Classes and functions of the stub: name to node."""
    tree = ast.parse(STUB.read_text(encoding="utf-8"))
    return {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}


def parameters(function):
    """Names and defaults of a stub's function."""
    names = [*function.args.args, *function.args.kwonlyargs]
    first = len(function.args.args) - len(function.args.defaults)
    defaults = [None] * first + [*function.args.defaults, *function.args.kw_defaults]
    return [(name.arg, inspect.Parameter.empty if default is None else ast.literal_eval(default))
            for name, default in zip(names, defaults)]


def signature(function):
    return [(p.name, p.default) for p in inspect.signature(function).parameters.values()]


class Stub(unittest.TestCase):
    def test_every_public_name_is_in_the_stub(self):
        imported = {alias.asname for node in ast.parse(STUB.read_text(encoding="utf-8")).body
                    if isinstance(node, ast.ImportFrom) for alias in node.names}
        for name in splinecast.__all__:
            self.assertTrue(name in imported or name in stubbed() or name == "__version__", name)
        self.assertEqual(set(splinecast.__all__), {name for name in vars(splinecast) if not name.startswith("_")}
                         - {"errors", "records", "statuses"} | {"__version__"})
        self.assertTrue(STUB.with_name("py.typed").is_file())

    def test_every_method_and_parameter_is_in_the_stub(self):
        for name, node in stubbed().items():
            thing = getattr(splinecast, name)
            if isinstance(node, ast.FunctionDef):
                self.assertEqual(signature(thing), parameters(node), name)
                continue
            members = {part.name: part for part in node.body if isinstance(part, ast.FunctionDef)}
            public = {n for n in vars(thing) if not n.startswith("_")}
            special = {"__call__", "__len__", "__getitem__", "__array__", "__enter__", "__exit__"} & set(vars(thing))
            self.assertEqual(public | special, set(members) - {"__init__"}, name)
            for member, part in members.items():
                if member in ("__init__", "__exit__") or part.decorator_list:
                    continue
                self.assertEqual(signature(getattr(thing, member)), parameters(part), f"{name}.{member}")

    def test_the_constructors_take_the_parameters_of_the_stub(self):
        for name, node in stubbed().items():
            for part in node.body:
                if isinstance(part, ast.FunctionDef) and part.name == "__init__":
                    self.assertEqual(signature(getattr(splinecast, name)), parameters(part)[1:], name)

    def test_everything_has_a_docstring_with_its_parameters(self):
        for name in set(splinecast.__all__) - {"__version__", "Limits"}:
            thing = getattr(splinecast, name)
            self.assertTrue(inspect.getdoc(thing), name)
            for member, value in vars(thing).items() if inspect.isclass(thing) else ():
                if member.startswith("_") or not (callable(value) or isinstance(value, property)):
                    continue
                self.assertTrue(inspect.getdoc(getattr(thing, member)), f"{name}.{member}")
        self.assertRegex(splinecast.Producer.append.__doc__, "Append a waypoint.\n(.|\n)+\n\nParameters\n-+\nt : int or float")
        for name in ("Producer", "Solver", "Reader", "State", "fit"):
            doc = inspect.getdoc(getattr(splinecast, name))
            for parameter, _ in signature(getattr(splinecast, name)):
                self.assertRegex(doc, rf"(?m)^(?:.*, )?{parameter}(?:, .*)? : ", name)

    def test_statuses_are_those_of_the_library(self):
        self.assertEqual(str(splinecast.AppendStatus.TOO_FAR_APART), "too far apart")
        self.assertEqual(f"{splinecast.SampleStatus.NO_DATA}", "no data")
        header = (Path(__file__).parents[3] / "ipc/include/splinecast/status.hpp").read_text(encoding="utf-8")
        for enumeration in (splinecast.AppendStatus, splinecast.Refusal, splinecast.SampleStatus):
            body = header.split(f"enum class {enumeration.__name__} ")[1].split("};")[0].split("{")[1]
            words = [line.split(",")[0].split("=")[0].strip() for line in body.splitlines()
                     if line.strip() and not line.strip().startswith("///")]
            self.assertEqual([member.name.lower() for member in enumeration], words)


class Program(unittest.TestCase):
    def run_it(self, *arguments, **how):
        return subprocess.run([sys.executable, "-m", "splinecast", *arguments], text=True, capture_output=True, **how)

    def test_the_module_runs_the_program(self):
        run = self.run_it("methods")
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        self.assertIn("c2", run.stdout)
        self.assertEqual(self.run_it("no-such-verb").returncode, 2)

    def test_a_missing_program_is_named(self):
        package = Path(splinecast.__file__).parent
        code = (f"import runpy, pathlib; pathlib.Path.resolve = lambda p: pathlib.Path('/a/b/c/d/e/f.py'); "
                f"runpy.run_path('{package}/__main__.py', run_name='__main__')")
        run = subprocess.run([sys.executable, "-c", code], text=True, capture_output=True,
                             env={**os.environ, "PATH": "/nowhere"})
        self.assertEqual(run.returncode, 1)
        self.assertRegex(run.stderr, "the program is not in /a/b/c/bin, /a/bin or PATH")


if __name__ == "__main__":
    unittest.main()
