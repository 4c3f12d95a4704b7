#!/usr/bin/env python3
"""The menu of the site, as Doxygen's layout file: the groups of docs/README.md with their pages, then the reference.

layout.py DEFAULT_LAYOUT: prints it, for Doxygen in the root of the repository.
"""
import pathlib
import re
import sys
from xml.sax.saxutils import quoteattr


def user(url, title):
    return f'<tab type="user" visible="yes" url={quoteattr(url)} title={quoteattr(title)}/>'


tabs = ['<tab type="mainpage" visible="yes" title="Gallery"/>', user("@ref page_README", "README")]
readme = pathlib.Path("docs/README.md").read_text()
for title, text in re.findall(r"^\*\*(.+?)\*\*\n(.*?)(?=^\*\*|\Z)", readme, re.M | re.S):
    tabs.append(f'<tab type="usergroup" visible="yes" title={quoteattr(title)}>')
    for name in dict.fromkeys(re.findall(r"\]\(([\w./]+)\.md\)", text)):
        file = "docs/" + name if not name.startswith("../") else name[3:]
        heading = pathlib.Path(file + ".md").read_text().partition("\n")[0].lstrip("# ")
        if file != "docs/GALLERY":
            tabs.append(user(f"@ref page_{file.replace('/', '_')}", heading.replace("`", "")))
    tabs.append("</tab>")
tabs += [
    '<tab type="usergroup" visible="yes" title="Reference">',
    '<tab type="classlist" visible="yes" title="C++ and Python: types"/>',
    '<tab type="namespacemembers" visible="yes" title="C++: functions"/>',
    '<tab type="filelist" visible="yes" title="C++: headers"/>',
    user("@ref lorica.h", "C"),
    '<tab type="examples" visible="yes" title="Samples"/>',
    "</tab>",
]
menu = "<navindex>\n" + "\n".join(tabs) + "\n</navindex>"
print(re.sub(r"<navindex>.*</navindex>", lambda _: menu, pathlib.Path(sys.argv[1]).read_text(), flags=re.S))
