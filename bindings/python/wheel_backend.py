"""Makes the wheel (PEP 517) without other packages: CMake builds the module, and this packs it.

`pip wheel . --config-settings=build-dir=build` packs what is built in that folder already; nothing is built there.
`--config-settings=bundle=yes` packs the shared libraries too, for machines without them, and `other-python=313` the module
of LORICA_OTHER_PYTHON (bindings/python/CMakeLists.txt): scripts/release does.
"""

import base64
import hashlib
import platform
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


def tag(settings=None):
    """For this Python and this machine, whose shared libraries the module uses; if these are packed, for its C library."""
    python = f"cp{abi(settings)}"
    system = re.sub("[-.]", "_", sysconfig.get_platform())
    if bundles(settings):
        system = f"manylinux_{platform.libc_ver()[1].replace('.', '_')}_{platform.machine()}"
    return f"{python}-{python}-{system}"


def abi(settings):
    return (settings or {}).get("other-python", f"{sys.version_info.major}{sys.version_info.minor}")


def bundles(settings):
    return bool(settings) and settings.get("bundle") == "yes"


def built(settings):
    """A build folder with the module."""
    if settings and "build-dir" in settings:
        return ROOT / settings["build-dir"]
    folder = ROOT / "build-wheel"
    options = ["-DLORICA_BINDINGS=ON", "-DLORICA_TESTS=OFF", f"-DPython_EXECUTABLE={sys.executable}"]
    subprocess.run(["cmake", "--preset", "release", "-B", str(folder), *options], cwd=ROOT, check=True)
    subprocess.run(["cmake", "--build", str(folder), "--parallel", "--target", "lorica_python"], check=True)
    return folder


def package(folder, stage, settings, info):
    """The installed package, with the module and the program that it needs at times, and all that they load if asked for."""
    install = ["cmake", "--install", str(folder), "--strip", "--component", "python", "--prefix", str(stage)]
    subprocess.run(install, check=True, stdout=subprocess.DEVNULL)
    found = next(stage.rglob("__init__.py")).parent
    files = [folder / "lib" / "lorica" / name for name in ("liblorica_level_set.so", READER)]
    if settings and "other-python" in settings:
        next(found.glob("_lorica.*.so")).unlink()
        files.append(next((folder / "other_python").glob(f"_lorica.cpython-{abi(settings)}-*.so")))
    for file in files:
        shutil.copy(file, found)
        subprocess.run(["strip", "--strip-unneeded", str(found / file.name)], check=True)
    if bundles(settings):
        sys.path.insert(0, str(ROOT / "tools/packaging"))
        from bundle import bundle

        programs = [*found.glob("*.so"), found / READER]
        bundle(programs, found.parent / "lorica.libs", found.parent / info / "licenses", rename=True)
    files = sorted(file for folder in ("lorica", "lorica.libs", info) for file in (found.parent / folder).glob("**/*"))
    return {str(file.relative_to(found.parent)): file.read_bytes() for file in files if file.is_file()}


def about(info, settings=None):
    """The files that describe a wheel."""
    numpy = "numpy" if int(abi(settings)) >= 313 else "numpy <2"  # Debian 12's pybind11 2.10 knows no newer one
    metadata = f"""Metadata-Version: 2.1
Name: lorica-collision
Version: {version()}
Summary: {SUMMARY}
License: Apache-2.0
License-File: LICENSE
Requires-Python: >=3.9
Requires-Dist: {numpy}
"""
    wheel = f"Wheel-Version: 1.0\nGenerator: lorica {version()}\nRoot-Is-Purelib: false\nTag: {tag(settings)}\n"
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
    info = f"lorica_collision-{version()}.dist-info"
    (Path(metadata_directory) / info).mkdir()
    for path, content in about(info, config_settings).items():
        (Path(metadata_directory) / path).write_bytes(content)
    return info


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    info = f"lorica_collision-{version()}.dist-info"
    with tempfile.TemporaryDirectory() as stage:
        files = {**package(built(config_settings), Path(stage), config_settings, info), **about(info, config_settings)}
    files[f"{info}/RECORD"] = record(files, info)
    name = f"lorica_collision-{version()}-{tag(config_settings)}.whl"
    with zipfile.ZipFile(Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in files.items():
            entry = zipfile.ZipInfo(path)  # its time is fixed, so that equal builds give equal wheels
            entry.compress_type = zipfile.ZIP_DEFLATED
            mode = 0o755 if content.startswith(b"\x7fELF") else 0o644
            entry.external_attr = (stat.S_IFREG | mode) << 16  # pip believes only the mode of a regular file
            wheel.writestr(entry, content)
    return name


def build_sdist(sdist_directory, config_settings=None):
    raise NotImplementedError("the sources are the repository")
