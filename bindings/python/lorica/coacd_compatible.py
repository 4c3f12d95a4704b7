"""The call shape of the coacd module, over Lorica: change one import to try it.

    import lorica.coacd_compatible as coacd
    parts = coacd.run_coacd(coacd.Mesh(vertices, faces), threshold=0.05)

`threshold` is the largest concavity of a part, as CoACD measures it, in halves of the longest side of the mesh's bounds:
numbers of hulls can be compared. Open surfaces become thin walls, unless nothing outside can reach what is behind them.
"""

from __future__ import annotations

from typing import Any, List

import numpy as np

from . import _lorica

__all__ = ["Mesh", "run_coacd", "set_log_level"]


class Mesh:
    """A triangle mesh: vertices (n, 3), indices (m, 3)."""

    def __init__(self, vertices: Any, indices: Any) -> None:
        self.vertices = vertices
        self.indices = indices


def run_coacd(
    mesh: Mesh,
    threshold: float = 0.05,
    max_convex_hull: int = -1,
    preprocess_mode: str = "auto",
    preprocess_resolution: int = 50,
    resolution: int = 2000,
    mcts_nodes: int = 20,
    mcts_iterations: int = 150,
    mcts_max_depth: int = 3,
    pca: bool = False,
    merge: bool = True,
    decimate: bool = False,
    max_ch_vertex: int = 256,
    extrude: bool = False,
    extrude_margin: float = 0.01,
    apx_mode: str = "ch",
    seed: int = 0,
    real_metric: bool = False,
) -> List[List[np.ndarray]]:
    """Decompose a mesh. Returns [vertices, faces] of each hull.

    Used: threshold; max_convex_hull (-1 = no limit); preprocess_mode ("auto", "on", "off": whether a closed surface is
    built); decimate with max_ch_vertex; real_metric (threshold is in the mesh's unit). Refused: extrude, and an apx_mode
    other than "ch". Without effect: the other numbers, which steer CoACD's own search, and seed, for there is no chance.
    """
    if extrude:
        raise ValueError("extrude: Lorica's hulls are not extruded")
    if apx_mode != "ch":
        raise ValueError(f"apx_mode: found {apx_mode}, expected ch: Lorica makes convex hulls")
    closed = {"auto": "auto", "on": "always", "off": "never"}
    if preprocess_mode not in closed:
        raise ValueError(f"preprocess_mode: found {preprocess_mode}, expected auto, on or off")
    if not threshold > 0:
        raise ValueError(f"threshold: found {threshold}, expected more than 0")
    vertices = np.asarray(mesh.vertices)
    concavity = float(threshold)
    if real_metric and vertices.ndim == 2 and len(vertices) > 0:
        concavity /= 0.5 * float(np.ptp(vertices, axis=0).max()) or 1.0
    parts = _lorica.decompose(
        vertices,
        mesh.indices,
        max(max_convex_hull, 0),
        max_concavity=concavity,
        hull_vertices=max_ch_vertex if decimate else 0,
        closed_body=closed[preprocess_mode],
    )
    return [[hull.vertices, hull.faces] for hull in parts]


def set_log_level(level: str) -> None:
    """Does nothing: Lorica prints nothing."""
