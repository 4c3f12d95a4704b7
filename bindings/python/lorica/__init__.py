"""Convex parts of meshes and of moving characters, for physics engines.

    parts = lorica.decompose(vertices, faces, parts=16)
    for hull in parts: hull.vertices, hull.faces

    body = lorica.Character("hero.glb").body()
    for frame in lorica.play("walk", body): frame.hulls

What it needs from you is said in the docstrings; what it does is in docs/PYTHON.md.
"""

from ._lorica import (
    Body,
    Cancelled,
    Character,
    Contact,
    Frame,
    Hull,
    Live,
    Parts,
    Player,
    Touch,
    __version__,
    contacts,
    decompose,
    load_parts,
    play,
    read_mesh,
)

__all__ = [
    "Body",
    "Cancelled",
    "Character",
    "Contact",
    "Frame",
    "Hull",
    "Live",
    "Parts",
    "Player",
    "Touch",
    "contacts",
    "decompose",
    "load_parts",
    "play",
    "read_mesh",
]

for _public in __all__:
    globals()[_public].__module__ = "lorica"
