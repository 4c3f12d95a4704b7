#!/usr/bin/env python3
"""Copies the shared libraries that programs load beside them, so that they run where only the C and C++ runtimes are.

usage: bundle.py LIBRARIES LICENSES FILE...          into a folder that the files' run paths name
       bundle.py --rename LIBRARIES LICENSES FILE... under names of their own, so that no other library of the same name, of
                                                     another wheel, takes their place; the files are changed for it
"""
import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

RUNTIME = ("linux-vdso", "ld-linux", "libc.so", "libm.so", "libdl.so", "libpthread.so", "librt.so", "libresolv.so", "libutil.so",
           "libstdc++.so", "libgcc_s.so")


def said(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def loaded_by(files):
    """Names and paths of all that the files load, without the runtimes."""
    found = {}
    for file in files:
        for line in said("ldd", str(file)).splitlines():
            name, _, path = line.strip().partition(" => ")
            path = path.split(" (")[0]
            if path == "not found":
                raise SystemExit(f"bundle.py: {file} needs {name}, which is not installed")
            if path.startswith("/") and not name.startswith(RUNTIME):
                found[name] = Path(path).resolve()
    return {name: found[name] for name in sorted(found)}


def licence(path, folder):
    """The package's copyright file; a package may own a path under /usr or without it."""
    for name in (str(path), str(path).removeprefix("/usr")):
        owner = subprocess.run(["dpkg", "-S", name], capture_output=True, text=True)
        if owner.returncode == 0:
            package = owner.stdout.split(":")[0]
            shutil.copyfile(f"/usr/share/doc/{package}/copyright", folder / package)
            return
    raise SystemExit(f"bundle.py: no package owns {path}, so its licence is unknown")


def swap(file, names):
    """Names what the file loads anew, one at a time: patchelf 0.14 mixes up the versions of several."""
    for needed in said("patchelf", "--print-needed", str(file)).split():
        if needed in names:
            said("patchelf", "--replace-needed", needed, names[needed], str(file))


def bundle(files, libraries, licenses, rename=False):
    if shutil.which("patchelf") is None:
        raise SystemExit("bundle.py: patchelf is missing; install Debian's package of that name (scripts/setup --release)")
    libraries.mkdir(parents=True, exist_ok=True)
    licenses.mkdir(parents=True, exist_ok=True)
    copies, names = [], {}
    for name, path in loaded_by(files).items():
        if rename:
            digest = hashlib.sha256(path.read_bytes()).hexdigest()[:8]
            names[name] = name.replace(".so", f"-{digest}.so", 1)
        copies.append(libraries / names.get(name, name))
        shutil.copyfile(path, copies[-1])
        copies[-1].chmod(0o755)
        licence(path, licenses)
    for copy in copies:
        said("patchelf", "--set-rpath", "$ORIGIN", str(copy))
        if rename:
            said("patchelf", "--set-soname", copy.name, str(copy))
            swap(copy, names)
    for file in files:  # those that lie among the libraries have no run path that leads there
        if file.parent == libraries:
            said("patchelf", "--set-rpath", "$ORIGIN", str(file))
    for file in files if rename else ():
        said("patchelf", "--set-rpath", f"$ORIGIN:$ORIGIN/{os.path.relpath(libraries, file.parent)}", str(file))
        swap(file, names)


if __name__ == "__main__":
    renamed = sys.argv[1:2] == ["--rename"]
    places = [Path(argument) for argument in sys.argv[1 + renamed:]]
    if len(places) < 3:
        sys.exit(__doc__)
    bundle(places[2:], places[0], places[1], renamed)
