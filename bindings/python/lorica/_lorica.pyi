from os import PathLike
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple, Union, type_check_only

import numpy as np
from numpy.typing import ArrayLike, NDArray

Progress = Callable[[int, int], Optional[bool]]
Path = Union[str, "PathLike[str]"]

__version__: str

class Cancelled(RuntimeError):
    """The progress function returned False."""

class Hull:
    """A convex polyhedron."""
    @property
    def vertices(self) -> NDArray[np.float64]:
        """(n, 3) float64, read-only, no copy. Of a mesh in its unit; of a character in metres, in world space."""
    @property
    def faces(self) -> NDArray[np.int32]:
        """(m, 3) int32, read-only, no copy: triangles, counter-clockwise seen from outside. None while it is flat."""
    @property
    def volume(self) -> float:
        """In the cubed unit of the vertices."""

class Parts:
    """The convex hulls of a mesh: a sequence of Hull; of a mesh in several frames, those of the first."""
    def __len__(self) -> int:
        """Number of hulls."""
    def __getitem__(self, index: int) -> Hull:
        """A hull by its number, from 0."""
    def __iter__(self) -> Iterator[Hull]:
        """All hulls."""
    @property
    def hulls(self) -> List[Hull]:
        """A list of Hull."""
    @property
    def frame_count(self) -> int:
        """1, or as many as the vertices had."""
    def frame(self, index: int) -> List[Hull]:
        """The hulls of a frame, in the order of the parts: a list of Hull."""
    @property
    def mesh_volume(self) -> float:
        """Of the mesh, or of the closed body that was built for it; in the first frame."""
    @property
    def hull_volume(self) -> float:
        """The sum over the hulls, in the first frame."""
    @property
    def error(self) -> float:
        """(hull volume - mesh volume) / mesh volume; of several frames, the mean."""
    @property
    def errors(self) -> List[float]:
        """The error of each frame."""
    @property
    def keyframes(self) -> List[int]:
        """The frames that the mesh was decomposed in; the others are unseen."""
    @property
    def hash(self) -> str:
        """Of the parts, as `lorica decompose` prints it."""
    @property
    def repaired(self) -> str:
        """What was done to the mesh first, in words; empty if nothing."""
    def save(self, file: Path) -> None:
        """Writes a .lorica file. It holds no positions: load_parts() and the command need the mesh, too."""

class Character:
    """A character: a skinned mesh with a skeleton. Metres, Y up, facing +Z."""
    def __init__(
        self,
        file: Path = "mannequin",
        *,
        map: Optional[Path] = None,
        walls: str = "solid",
        thickness: float = 0.0,
        body_resolution: float = 0.0,
        hidden: Sequence[str] = (),
        expressions: Sequence[str] = (),
    ) -> None:
        """Read .glb, .gltf, .vrm, .fbx or .dae; or the built-in "mannequin".

        An open surface gets a closed body.

        map              file that says which joints are the humanoid's bones; None = automatic
        walls            what an open surface is: "solid", unless all of it is sheets; "auto" = a thin wall, unless nothing
                         outside can reach what is behind it; "shell" = a thin wall, also where it is closed
        thickness        of thin walls [m]; 0 = 1 % of their longest side, at most half of the narrowest gap
        body_resolution  of the voxels of a closed body, if one has to be made [m]; 0 = automatic
        hidden           names of meshes that are left out, such as a weapon
        expressions      "NAME=WEIGHT" each; the hulls hold what these morph
        """
    @property
    def name(self) -> str:
        """Of the file."""
    @property
    def height(self) -> float:
        """In the bind pose [m]."""
    @property
    def joints(self) -> List[str]:
        """Names, parents before children."""
    @property
    def parents(self) -> List[int]:
        """For each joint its parent's index; -1 = none."""
    @property
    def clips(self) -> List[str]:
        """Names of its own animations."""
    @property
    def first_guess(self) -> str:
        """What the file was taken to be: rest pose, unit, axes, facing and floor, in words."""
    @property
    def notes(self) -> List[str]:
        """What was repaired, guessed or left out when the file was read: one sentence each."""
    @property
    def vertices(self) -> NDArray[np.float64]:
        """(n, 3) float64, read-only, no copy: of the closed body in the bind pose [m]."""
    @property
    def faces(self) -> NDArray[np.int32]:
        """(m, 3) int32, read-only, no copy: the closed body."""
    def body(
        self,
        parts: int = 0,
        *,
        cover: Optional[float] = None,
        hull_vertices: int = 0,
        threads: int = 0,
        progress: Optional[Progress] = None,
    ) -> Body:
        """Decompose the character, trained on its own clips and on recordings of people.

        parts          at most this many; 0 = the body of `lorica play`, 16 parts, kept in the user's cache
        cover          length [m]: use fewer points, so that the surface sticks out by at most this before the hulls are
                       enlarged to hold it; None or 0 = all points
        hull_vertices  at most this many in each hull and frame, at least 4; 0 = no limit
        threads        0 = all of the machine's
        progress       called with the numbers of parts done and wanted; return False to cancel
        """
    def load_body(self, file: Path) -> Body:
        """The body in a .lorica file that was made from this character."""

class Body:
    """A decomposed character. Immutable; threads may share it."""
    def __len__(self) -> int:
        """Number of parts."""
    @property
    def character(self) -> Character:
        """The one it was made from."""
    @property
    def error(self) -> float:
        """(hull volume - mesh volume) / mesh volume, mean over the training poses."""
    def live(self) -> Live:
        """A live body, to be moved by your own skeleton."""
    def save(self, file: Path) -> None:
        """Write a .lorica file, for load_body() and the command."""

class Frame:
    """A body in one pose. It stays as it is when the body moves on."""
    @property
    def time(self) -> float:
        """In the motion [s]."""
    @property
    def hulls(self) -> List[Hull]:
        """A Hull for each part, in world space [m]."""
    @property
    def world_from_joint(self) -> NDArray[np.float64]:
        """(joints, 4, 4) float64, read-only, no copy."""

class Contact:
    """Two parts of one body that overlap and are no neighbours."""
    @property
    def first(self) -> int:
        """Index of a part, below `second`."""
    @property
    def second(self) -> int:
        """Index of the other part."""
    @property
    def position(self) -> NDArray[np.float64]:
        """(3,) float64: where the overlap is deepest, world [m]."""
    @property
    def direction(self) -> NDArray[np.float64]:
        """(3,) float64: unit, from the first part to the second."""
    @property
    def depth(self) -> float:
        """How far the second has to move along the direction [m]."""

class Touch:
    """A part of a body and a shape of yours that overlap."""
    @property
    def part(self) -> int:
        """Index of the part."""
    @property
    def position(self) -> NDArray[np.float64]:
        """(3,) float64: where the overlap is deepest, world [m]."""
    @property
    def direction(self) -> NDArray[np.float64]:
        """(3,) float64: unit, from the part to the shape."""
    @property
    def depth(self) -> float:
        """How far the shape has to move along the direction [m]."""

@type_check_only
class _Posed:
    """What a moved body can be asked about its last pose."""
    def motion(
        self, seconds: float
    ) -> Tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """How the parts moved from the pose before the last to the last one.

        Returns (world_from_part, previous_world_from_part, linear, angular): float64 (parts, 4, 4), (parts, 4, 4), the frames of
        the parts, which follow the best-fit rigid motion of their points, in this pose and the one before; (parts, 3), velocities
        of their origins [m/s]; (parts, 3), about world axes [rad/s]. After the first pose nothing has moved.

        seconds  between the two poses, above 0
        """
    def swept(self) -> List[Hull]:
        """What each part swept by a straight motion from the pose before the last to the last one: a list of Hull, world [m]."""
    def touches(self, points: ArrayLike, radius: float = 0.0) -> List[Touch]:
        """Parts that a convex solid of yours overlaps in the last pose: a list of Touch.

        The solid is everything within `radius` of the convex hull of `points`: one point makes a ball, two a capsule, eight
        corners a box.

        points  (n, 3) or (3,) numbers, world [m]
        radius  0 or more [m]
        """
    def cast(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        reach: float = ...,
        radius: float = 0.0,
        half: Sequence[float] = ...,
    ) -> Tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Where rays enter the hulls in the last pose, each the nearest hull on its way; or where
        balls or capsules that are swept along them touch.

        Returns (parts, distances, positions, normals) of n rays: int32 (n,), -1 where nothing is hit; float64 (n,) [m], 0 where
        a ray begins inside, inf where nothing is hit; float64 (n, 3), world [m], nan where nothing is hit; float64 (n, 3), unit,
        outward, against rays that begin inside. Before the first pose nothing is hit.

        origins     (n, 3) numbers, or one point for all rays, world [m]
        directions  (n, 3) numbers, of any length above 0
        reach       where the rays end [m]
        radius      of balls or capsules [m]; 0 = rays
        half        x y z from the middle of a capsule, which moves along the ray, to an end of its axis [m]; 0 = balls
        """
    def cast_on_skin(
        self, origins: ArrayLike, directions: ArrayLike, reach: float = ...
    ) -> Tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Where rays meet the skin in the last pose, from either side.

        It is looked for in hulls that the rays enter; a ray that passes a hull but not the skin within goes on to the next hull.
        Returns (triangles, weights, distances, positions) of n rays: int32 (n,), rows of Character.faces, -1 where no skin is
        met; float64 (n, 3), barycentric: of the triangles' corners, nan where no skin is met; float64 (n,) [m], inf where no
        skin is met; float64 (n, 3), world [m], nan where no skin is met.

        origins     (n, 3) numbers, or one point for all rays, world [m]
        directions  (n, 3) numbers, of any length above 0
        reach       where the rays end [m]
        """

class Live(_Posed):
    """A body that is moved. Threads may share it, one call at a time."""
    def pose(self, world_from_joint: ArrayLike) -> Frame:
        """Move it: (joints, 4, 4) finite numbers, each joint's transform to world space [m]. Returns a Frame at 0 s."""
    def contacts(self) -> List[Contact]:
        """Overlaps of its own parts in the last pose: a list of Contact."""

class Player(_Posed):
    """A motion on a body: an iterator of Frame."""
    def __iter__(self) -> Player:
        """Itself."""
    def __next__(self) -> Frame:
        """The next frame."""
    def __len__(self) -> int:
        """Number of frames."""
    @property
    def times(self) -> List[float]:
        """Of the frames [s]."""
    @property
    def first_guess(self) -> str:
        """What the motion's file was taken to be: rest pose, unit, axes, facing and floor, in words."""
    def at(self, time: float) -> Frame:
        """The Frame at any time [s], between two frames interpolated; before the first and after the last the body keeps their pose. Iteration goes on where it was."""
    def contacts(self) -> List[Contact]:
        """Overlaps of the body's own parts in the last frame: a list of Contact."""

def decompose(
    vertices: ArrayLike,
    faces: ArrayLike,
    parts: Optional[int] = None,
    *,
    max_error: float = 0.0,
    max_distance: float = 0.0,
    max_concavity: float = 0.0,
    preset: str = "fast",
    hull_vertices: int = 0,
    hull_planes: int = 0,
    closed_body: str = "auto",
    walls: str = "auto",
    thickness: float = 0.0,
    threads: int = 0,
    progress: Optional[Progress] = None,
    keyframes: Optional[int] = None,
    candidates: int = 0,
) -> Parts:
    """Decompose a mesh into nearly convex parts, and return their hulls.

    The hulls together contain every vertex of the surface. The same arguments give the same hulls on any number of threads:
    there is no seed. A mesh with small faults is repaired; an open one gets a closed body, see `closed_body`.

    vertices       (n, 3) finite numbers, in any unit; or (k, n, 3): the mesh in k frames, whose hulls Parts.frame() has
    faces          (m, 3) integers: triangles, counter-clockwise seen from outside
    parts          at most this many; 0 = until no concave edge remains; None = 16, or with a limit below as many as it takes
    max_error      stop when the hulls have at most this much more volume, relative to the mesh; 0 = no limit
    max_distance   use the fewest parts with no point of a hull farther than this from the surface; 0 = no limit
    max_concavity  use the fewest parts whose concavity, as CoACD measures it, is at most this; 0 = no limit
    preset         "paper", "fast" or "quality"
    hull_vertices  enclose hulls with more vertices in larger ones with at most this many, at least 4; 0 = no limit. It and
                   parts always hold; the limits give where not all can
    hull_planes    the same for planes of hulls: flat faces, of any number of corners
    closed_body    "auto" builds a closed surface if the mesh cannot be repaired, "never" refuses such a mesh, "always"
    walls          what an open surface is: "auto" = a thin wall, unless nothing outside can reach what is behind it; "solid";
                   "shell" = a thin wall, also where it is closed
    thickness      of thin walls; 0 = 1 % of the longest side, at most half of the narrowest gap
    threads        0 = all of the machine's
    progress       called with the numbers of parts done and wanted; return False to cancel
    keyframes      of several frames, decompose in so many at even intervals; None = up to 12 that differ most
    candidates     concave edges that are tried for each cut; 0 = the preset's, 8

    Other threads of Python run meanwhile; Ctrl-C cancels. Raises ValueError with a sentence, or Cancelled.
    Warns, as a RuntimeWarning, of an error above 50 %.
    """
def load_parts(file: Path, vertices: ArrayLike, faces: ArrayLike, *, hull_vertices: int = 0, hull_planes: int = 0) -> Parts:
    """The parts in a .lorica file that was made from this mesh, or from one with the same faces."""
def read_mesh(file: Path) -> Tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Read .off, .obj, .ply or .stl: (n, 3) float64 vertices and (m, 3) int32 faces, read-only, no copy."""
def contacts(
    motion: Path,
    character: Path = "",
    *,
    scene: Path = "",
    near: float = 0.05,
    clip: str = "",
    mirror: bool = False,
    decomposition: Path = "",
    threads: int = 0,
    progress: Optional[Progress] = None,
) -> Dict[str, NDArray[Any]]:
    """A table of all contacts in a motion, as `lorica contacts` writes it: a dict of arrays.

    Each row is a contact, or a pair that is nearly one, in a frame: frame, time [s], kind (index of `kinds`), avatar, part,
    bone (index of `bones`), other_avatar, other_part, other_bone, prop (-1 = none), depth [m] (below 0 the distance), point
    and normal (n, 3), velocity (n, 3) of the other [m/s], strength [N s], slip [m/s], foot (index of `feet`), phase (index of
    `phases`). For each frame: frame_time, frame_standing (frames, avatars, 2). `notes` has what should be known.

    motion         as for play(); several are separated by commas
    character      file or "mannequin"; "" = the mannequin, or the motion's own character
    scene          file or name of a shipped scene; "" = only a floor
    near           greatest distance of rows [m]
    decomposition  .lorica file of the character; "" = the body of `lorica play`
    progress       called with numbers of parts; return False to cancel
    """
def play(motion: Path, body: Body, *, clip: str = "", mirror: bool = False) -> Player:
    """Let a body perform a motion: `for frame in lorica.play("walk.bvh", body): frame.hulls`.

    motion  recorded joints (.csv, .txt, .json), .bvh, depth (.oni), or a character file with clips; or the name of a shipped
            recording: "walk"
    clip    of a character file with several; empty = the first
    mirror  swap left and right
    """
