"""Makes the wheel (PEP 517) without other packages: CMake builds the module, and this packs it.

`pip wheel . --config-settings=build-dir=build` packs what is built in that folder already; nothing is built there.
"""

import base64
import hashlib
import re
import shutil
import stat
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
READER = "lorica_character_reader"  # a program
SUMMARY = "Convex parts of meshes and of moving characters, for physics engines"


def version():
    return re.search(r"project\(\s*lorica\s+VERSION\s+([\d.]+)", (ROOT / "CMakeLists.txt").read_text(), re.I).group(1)


def tag():
    """For this Python and this machine, whose shared libraries the module uses."""
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def built(settings):
    """A build folder with the module."""
    if settings and "build-dir" in settings:
        return ROOT / settings["build-dir"]
    folder = ROOT / "build-wheel"
    options = ["-DLORICA_BINDINGS=ON", "-DLORICA_TESTS=OFF", f"-DPython_EXECUTABLE={sys.executable}"]
    subprocess.run(["cmake", "--preset", "release", "-B", str(folder), *options], cwd=ROOT, check=True)
    subprocess.run(["cmake", "--build", str(folder), "--parallel", "--target", "lorica_python"], check=True)
    return folder


def package(folder, stage):
    """The installed package, with the module and the program that it needs at times."""
    install = ["cmake", "--install", str(folder), "--strip", "--component", "python", "--prefix", str(stage)]
    subprocess.run(install, check=True, stdout=subprocess.DEVNULL)
    found = next(stage.rglob("__init__.py")).parent
    for name in ("liblorica_level_set.so", READER):
        shutil.copy(folder / "lib" / "lorica" / name, found)
    return {f"lorica/{file.name}": file.read_bytes() for file in sorted(found.iterdir())}


def about(info):
    """The files that describe a wheel."""
    metadata = f"""Metadata-Version: 2.1
Name: lorica
Version: {version()}
Summary: {SUMMARY}
License: Apache-2.0
License-File: LICENSE
Requires-Python: >=3.9
Requires-Dist: numpy
"""
    wheel = f"Wheel-Version: 1.0\nGenerator: lorica {version()}\nRoot-Is-Purelib: false\nTag: {tag()}\n"
    license_text = (ROOT / "LICENSE").read_bytes()
    return {f"{info}/METADATA": metadata.encode(), f"{info}/WHEEL": wheel.encode(), f"{info}/LICENSE": license_text}


def record(files, info):
    """Hashes and sizes of all files."""
    lines = []
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        lines.append(f"{name},sha256={digest},{len(content)}")
    return "\n".join([*lines, f"{info}/RECORD,,", ""]).encode()


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    info = f"lorica-{version()}.dist-info"
    (Path(metadata_directory) / info).mkdir()
    for path, content in about(info).items():
        (Path(metadata_directory) / path).write_bytes(content)
    return info


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    info = f"lorica-{version()}.dist-info"
    with tempfile.TemporaryDirectory() as stage:
        files = {**package(built(config_settings), Path(stage)), **about(info)}
    files[f"{info}/RECORD"] = record(files, info)
    name = f"lorica-{version()}-{tag()}.whl"
    with zipfile.ZipFile(Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in files.items():
            entry = zipfile.ZipInfo(path)  # its time is fixed, so that equal builds give equal wheels
            entry.compress_type = zipfile.ZIP_DEFLATED
            mode = 0o755 if path.endswith((".so", READER)) else 0o644
            entry.external_attr = (stat.S_IFREG | mode) << 16  # pip believes only the mode of a regular file
            wheel.writestr(entry, content)
    return name


def build_sdist(sdist_directory, config_settings=None):
    raise NotImplementedError("the sources are the repository")
