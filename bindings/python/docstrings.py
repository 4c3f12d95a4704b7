"""docstrings.py STUBS HEADER: makes a C++ header of the docstrings in the stubs, so that they are written once."""

import ast
import sys
from pathlib import Path

stubs, header = map(Path, sys.argv[1:])
documented = []
for node in ast.parse(stubs.read_text(encoding="utf-8")).body:
    if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
        documented.append((node.name, node))
        members = [member for member in node.body if isinstance(member, ast.FunctionDef)]
        documented += [(f"{node.name}.{member.name}", member) for member in members]
cases = "".join(f'  if (name == "{name}") return R"doc({ast.get_docstring(node)})doc";\n' for name, node in documented)
text = f"""// Made by bindings/python/docstrings.py of {stubs.name}.
#pragma once

#include <string_view>

namespace lorica {{

/// The docstring of a class, function or member in the stubs: "Live.cast".
consteval const char* docOf(std::string_view name) {{
{cases}  throw "the stubs have no such name";
}}

}}  // namespace lorica
"""
if not header.exists() or header.read_text(encoding="utf-8") != text:  # what includes it is compiled anew
    header.parent.mkdir(parents=True, exist_ok=True)
    header.write_text(text, encoding="utf-8")
