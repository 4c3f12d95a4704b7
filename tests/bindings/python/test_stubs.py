"""The type hints and docstrings agree with the module."""

import ast
import inspect
import re
import unittest
from pathlib import Path

import lorica
from lorica import _lorica

STUBS = ast.parse((Path(lorica.__file__).parent / "_lorica.pyi").read_text()).body
SHARED = {node.name: node for node in STUBS if isinstance(node, ast.ClassDef) and node.name.startswith("_")}
PUBLIC = [node for node in STUBS if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and node.name not in SHARED]


def members_of(node):
    """The functions of a class by name, with those that it shares with others."""
    body = [member for base in node.bases if base.id in SHARED for member in SHARED[base.id].body] + node.body
    return {member.name: member for member in body if isinstance(member, ast.FunctionDef)}


def arguments_of(function):
    """Names of a stub's arguments, and `*` before those that need a name; without self."""
    names = [a.arg for a in function.args.args if a.arg != "self"]
    return names + (["*"] if function.args.kwonlyargs else []) + [a.arg for a in function.args.kwonlyargs]


def runtime_arguments(function):
    """The same of a function of pybind11, whose docstring starts with its signature."""
    inside = re.search(r"\((.*)\) ->", function.__doc__.splitlines()[0]).group(1)
    names = [piece.split(":")[0].split("=")[0].strip() for piece in re.split(r",\s*(?=[\w*])", inside)]
    return [name for name in names if name and name != "self"]


class Stubs(unittest.TestCase):
    def test_they_have_every_public_name(self):
        stubbed = {node.name for node in PUBLIC}
        self.assertEqual(stubbed, {name for name in dir(_lorica) if not name.startswith("_")})
        self.assertEqual(stubbed, set(lorica.__all__))

    def test_classes_have_the_members(self):
        for node in PUBLIC:
            if not isinstance(node, ast.ClassDef) or node.name == "Cancelled":
                continue
            real = getattr(_lorica, node.name)
            stubbed = members_of(node)
            public = {name for name in vars(real) if not name.startswith("_")}
            self.assertEqual({name for name in stubbed if not name.startswith("_")}, public, node.name)
            for name, member in stubbed.items():
                found = getattr(real, name)
                is_property = any(getattr(d, "id", "") == "property" for d in member.decorator_list)
                self.assertEqual(isinstance(found, property), is_property, f"{node.name}.{name}")
                if not is_property and not name.startswith("__"):
                    self.assertEqual(runtime_arguments(found), arguments_of(member), f"{node.name}.{name}")

    def test_functions_have_the_arguments(self):
        for node in PUBLIC:
            if isinstance(node, ast.FunctionDef):
                self.assertEqual(runtime_arguments(getattr(_lorica, node.name)), arguments_of(node), node.name)

    def test_they_say_what_the_module_says(self):
        for node in PUBLIC:
            found = getattr(_lorica, node.name)
            stubbed = members_of(node) if isinstance(node, ast.ClassDef) else {}
            members = [(member, getattr(found, name)) for name, member in stubbed.items()]
            for stub, real in [(node, found), *members]:
                said = inspect.getdoc(real) or ""
                if "->" in said.split("\n")[0]:  # a function's own words follow its signature
                    said = said.partition("\n")[2].strip()
                if said:
                    self.assertEqual(ast.get_docstring(stub), said, f"{node.name}: {stub.name}")
                self.assertTrue(ast.get_docstring(stub), f"{node.name}: {stub.name}")

    def test_everything_is_documented(self):
        for name in lorica.__all__:
            thing = getattr(lorica, name)
            self.assertTrue(inspect.getdoc(thing), name)
            if inspect.isclass(thing) and name != "Cancelled":
                for member, value in vars(thing).items():
                    if not member.startswith("_"):
                        text = value.__doc__ or ""
                        # A function's own words follow its signature.
                        words = text if isinstance(value, property) else "".join(text.splitlines()[1:])
                        self.assertTrue(words.strip(), f"{name}.{member}")


if __name__ == "__main__":
    unittest.main()
