#!/usr/bin/env python3
"""Each file and anchor that pages of a folder link to exists, and no page loads anything from the network.

check_links.py FOLDER: prints what is wrong, and ends with 1 if anything is.
"""
import pathlib
import re
import sys
from html import unescape
from urllib.parse import unquote

folder = pathlib.Path(sys.argv[1])
pages = {page.name: page.read_text(errors="replace") for page in folder.glob("*.html")}
anchors = {name: set(re.findall(r'\b(?:id|name)="([^"]+)"', text)) for name, text in pages.items()}
# Doxygen 1.9.4 itself links to these without making them.
OWN = {"nested-classes", "pub-types", "pub-methods", "pub-attribs", "files", "typedef-members"}
wrong = set()
for name, text in pages.items():
    if "@ref" in text:
        wrong.add(f"{name}: a link was not understood: {text[text.index('@ref'):][:80]}")
    for attribute, link in re.findall(r'\b(href|src|poster)="([^"]*)"', text):
        link = unescape(link)
        if re.match(r"[a-z]+:", link):
            if attribute != "href" and not link.startswith("javascript:"):
                wrong.add(f"{name}: loads {link}")
            continue
        file, _, anchor = unquote(link).partition("#")
        if file and not (folder / file).exists():
            wrong.add(f"{name}: no file {link}")
        elif anchor and anchor not in OWN and anchor not in anchors.get(file or name, set()):
            wrong.add(f"{name}: no anchor {link}")
for sentence in sorted(wrong):
    print(sentence)
sys.exit(1 if wrong or not pages else 0)
