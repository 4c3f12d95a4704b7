#!/usr/bin/env python3
"""Opens pages of the site in Chromium, on a desk and on a phone, in both themes.

check_pages.py FOLDER: a page must fit the width, show its pictures, and have a search and a menu with the groups of
docs/README.md, on a phone behind a button. Prints what is wrong, and ends with 1 if anything is.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

folder = pathlib.Path(sys.argv[1]).resolve()
groups = re.findall(r"^\*\*(.+?)\*\*$", pathlib.Path("docs/README.md").read_text(), re.M)
PAGES = ["index.html", "page_docs_START.html", "page_docs_BENCHMARKS.html", "structlorica_1_1Decomposition.html", "lorica_8h.html"]
SCRIPT = """
const wrong = [], groups = %s, pages = %s;
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const until = async (holds) => { for (let i = 0; i < 200 && !holds(); ++i) await wait(50); return holds(); };
async function look(page, width) {
  const frame = document.createElement('iframe');
  frame.style.cssText = `border:0;width:${width}px;height:844px`;
  frame.src = page;
  document.body.append(frame);
  await new Promise((done) => { frame.onload = done; });
  const inner = frame.contentDocument, all = (what) => [...inner.querySelectorAll(what)];
  const seen = (what) => all(what).some((one) => one.getClientRects().length > 0);
  const say = (what) => wrong.push(`${page} at ${width} pixels: ${what}`);
  if (!(await until(() => all('#doc-content img').every((one) => one.complete && one.naturalWidth > 0)))) say('a picture is missing');
  if (inner.documentElement.scrollWidth > width + 1) say(`is ${inner.documentElement.scrollWidth} pixels wide`);
  if (!(await until(() => seen('#MSearchField')))) say('no search');
  if (!(await until(() => seen('doxygen-awesome-dark-mode-toggle')))) say('no choice of light and dark');
  const menu = width < 768 ? '#main-menu' : '#nav-tree';
  if (width < 768) {
    if (seen(menu)) say('the menu covers the page');
    const button = inner.querySelector('.main-menu-btn');
    if (await until(() => seen('.main-menu-btn'))) button.click(); else say('no button for the menu');
  }
  const text = () => all(menu).map((one) => one.textContent).join(' ');
  if (!(await until(() => seen(menu) && groups.every((group) => text().includes(group))))) say('the menu lacks groups: ' + text().slice(0, 99));
  frame.remove();
}
(async () => {
  for (const page of pages) for (const width of [1280, 390]) await look(page, width);
  document.title = 'done';
  document.body.textContent = 'RESULT' + JSON.stringify(wrong) + 'END';
})();
"""
check = folder / "check_pages.html"
check.write_text(f"<!doctype html><body><script>{SCRIPT % (json.dumps(groups), json.dumps(PAGES))}</script>")
wrong = []
try:
    for theme in ("light", "dark"):
        with tempfile.TemporaryDirectory() as profile:
            command = ["chromium", "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--allow-file-access-from-files",
                       f"--user-data-dir={profile}", "--window-size=1400,900", "--disable-background-networking",
                       "--virtual-time-budget=120000", "--dump-dom", check.as_uri()]
            if theme == "dark":
                command.insert(1, "--blink-settings=preferredColorScheme=0")
            shown = subprocess.run(command, capture_output=True, text=True, timeout=600)
        result = re.search(r"RESULT(\[.*?\])END", shown.stdout, re.S)
        wrong += [f"{theme}: {one}" for one in json.loads(result[1])] if result else [f"{theme}: nothing was shown: {shown.stderr[-300:]}"]
finally:
    check.unlink()
print("\n".join(wrong) or f"{len(PAGES)} pages were opened in Chromium, at two widths and in both themes")
sys.exit(1 if wrong else 0)
