import copy
import os
import pickle
import shutil
import tempfile
import unittest
from pathlib import Path

import lorica
import numpy as np
from shapes import FILES, box, farthest_outside, kilobytes_in_use


def bytes_of(frame):
    """As tests/bindings/truth.cpp writes a session's frame."""
    parts = (
        np.array([len(hull.vertices), len(hull.faces)], np.int32).tobytes() + hull.vertices.tobytes() + hull.faces.tobytes()
        for hull in frame.hulls
    )
    return b"".join(parts)


class Characters(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mannequin = lorica.Character()
        cls.body = cls.mannequin.load_body(FILES / "body.lorica")

    def use_all(self, unmade):
        """Every attribute of an object without content: the first raises, and none ends the interpreter."""
        error = None
        for name in (name for name in dir(unmade) if not name.startswith("_")):
            try:
                value = getattr(unmade, name)
                if callable(value):
                    value()
            except TypeError as each:
                error = error or each
        repr(unmade), hash(unmade)
        if error:
            raise error

    def test_objects_without_their_constructor_are_refused(self):
        frame = next(iter(lorica.play("walk", self.body)))
        parts = lorica.decompose(*box())
        for made in (self.mannequin, self.body, frame, frame.hulls[0], self.body.live(), parts, lorica.play("walk", self.body)):
            kind = type(made)
            for attempt in (
                lambda: self.use_all(kind.__new__(kind)),
                lambda: object.__new__(kind),
                lambda: copy.copy(made),
                lambda: copy.deepcopy(made),
                lambda: pickle.dumps(made),
            ):
                with self.assertRaises(TypeError):
                    attempt()
        with self.assertRaises(TypeError):
            lorica.Body()
        unmade = []

        class Mine(lorica.Character):
            def __new__(cls):
                with self.assertRaises(TypeError):
                    self.use_all(lorica.Hull.__new__(lorica.Hull))
                unmade.extend([lorica.Character.__new__(cls), lorica.Character.__new__(lorica.Character)])
                lorica.Character()
                return lorica.Character.__new__(cls)

        self.assertGreater(Mine().height, 0)
        for character in unmade:
            with self.assertRaisesRegex(TypeError, "made by __new__ alone and is empty"):
                self.use_all(character)
        self.assertEqual(lorica.Character("mannequin").body is None, False)

    def test_hulls_are_those_of_a_session_bit_for_bit(self):
        for motion, truth in (("walk", "walk_csv.hulls"), (FILES / "walk.bvh", "walk_bvh.hulls")):
            player = lorica.play(motion, self.body)
            found = b"".join(bytes_of(frame) for _, frame in zip(range(40), player))
            self.assertEqual(found, (FILES / truth).read_bytes())

    def test_the_body_is_the_commands_byte_for_byte(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "again.lorica"
            self.mannequin.body(4).save(file)
            self.assertEqual(file.read_bytes(), (FILES / "body.lorica").read_bytes())

    def test_hulls_hold_morph_targets_of_clips_as_the_commands(self):
        breathing = lorica.Character(FILES / "breathing.glb")
        self.assertEqual(breathing.notes, [])  # the hulls follow the clip, so they hold no more than it needs
        self.assertEqual(len(breathing.load_body(FILES / "breathing.lorica")), 2)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "again.lorica"
            breathing.body(2, hull_vertices=64).save(file)
            self.assertEqual(file.read_bytes(), (FILES / "breathing.lorica").read_bytes())

    def test_thin_walls_are_those_of_the_command(self):
        bucket = lorica.Character(FILES / "bucket.glb", walls="auto", thickness=0.02)
        self.assertTrue(any("thin wall of 20.00 mm" in note for note in bucket.notes), bucket.notes)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "again.lorica"
            bucket.body(3).save(file)
            self.assertEqual(file.read_bytes(), (FILES / "bucket.lorica").read_bytes())
        solid = lorica.Character(FILES / "bucket.glb")
        self.assertFalse(any("thin wall" in note for note in solid.notes), solid.notes)
        self.assertEqual(len(lorica.Character(FILES / "bucket.glb", walls="solid").vertices), len(solid.vertices))
        coarse = lorica.Character(FILES / "bucket.glb", body_resolution=0.03)
        self.assertLess(len(coarse.vertices), len(solid.vertices))

    def test_meshes_can_be_hidden_and_bones_assigned(self):
        hidden = lorica.Character(FILES / "bucket.glb", hidden=["Pail"])
        self.assertEqual(len(hidden.faces), len(self.mannequin.faces))
        with self.assertRaisesRegex(ValueError, "Nothing"):
            lorica.Character(FILES / "bucket.glb", hidden=["Nothing"])
        self.assertEqual(lorica.Character(FILES / "hero.glb", map=FILES / "hero_map.json").height,
                         lorica.Character(FILES / "hero.glb").height)
        with self.assertRaises(FileNotFoundError):
            lorica.Character(FILES / "hero.glb", map=FILES / "no_map.json")
        with self.assertRaisesRegex(ValueError, "Smile"):
            lorica.Character(FILES / "breathing.glb", expressions=["Smile=1"])

    def test_wrong_options_of_reading_are_named(self):
        for wrong, sentence in (
            ({"walls": "thick"}, "walls: found thick, expected solid, auto or shell"),
            ({"walls": "auto", "thickness": -0.1}, "thickness: found -0.1"),
            ({"thickness": 0.01}, "a thickness is for thin walls"),
            ({"body_resolution": float("nan")}, "body_resolution: found nan"),
        ):
            with self.assertRaisesRegex(ValueError, sentence):
                lorica.Character(FILES / "bucket.glb", **wrong)

    def test_first_guesses_are_those_of_the_command(self):
        self.assertIn("it faces +Z", lorica.Character(FILES / "hero.glb").first_guess)
        self.assertEqual(self.mannequin.first_guess, "")
        self.assertIn("centimetres, since the rest pose measures", lorica.play(FILES / "walk.bvh", self.body).first_guess)

    def test_frames_stay_when_the_body_moves_on(self):
        player = lorica.play("walk", self.body)
        first = next(player)
        before = bytes_of(first)
        last = list(player)[-1]
        self.assertEqual(bytes_of(first), before)
        self.assertNotEqual(bytes_of(last), before)
        self.assertEqual(last.time, player.times[-1])
        self.assertEqual(len(player), len(player.times))
        self.assertEqual(list(player), [])

    def test_own_transforms_give_the_same_hulls(self):
        live = self.body.live()
        for _, frame in zip(range(5), lorica.play("walk", self.body)):
            self.assertEqual(bytes_of(live.pose(frame.world_from_joint)), bytes_of(frame))

    def test_ten_thousand_poses_leak_nothing(self):
        live = self.body.live()
        poses = [frame.world_from_joint for _, frame in zip(range(40), lorica.play("walk", self.body))]

        def often(count):
            for call in range(count):
                frame = live.pose(poses[call % 40])
                frame.hulls[call % 4].vertices, frame.world_from_joint
            return kilobytes_in_use()

        first = often(500)
        self.assertLess(often(10000) - first, 500)  # [kB], or 50 bytes a call

    def test_any_time_can_be_asked_for(self):
        player = lorica.play("walk", self.body)
        between = (player.times[3] + player.times[4]) / 2
        frame = player.at(between)
        self.assertEqual(frame.time, between)
        hands = [lorica.play("walk", self.body).at(player.times[i]).world_from_joint[-1, :3, 3] for i in (3, 4)]
        middle = frame.world_from_joint[-1, :3, 3]
        self.assertLess(np.linalg.norm(middle - sum(hands) / 2), 0.01)
        with self.assertRaisesRegex(ValueError, "finite"):
            player.at(float("nan"))

    def test_a_files_own_clip_moves_it(self):
        hero = lorica.Character(FILES / "hero.glb")
        self.assertEqual(len(hero.joints), len(hero.parents))
        frame = next(lorica.play(FILES / "hero.glb", hero.body(2), clip="nod"))
        self.assertEqual(len(frame.hulls), 2)
        self.assertEqual(frame.world_from_joint.shape, (len(hero.joints), 4, 4))
        # The clip starts in the bind pose.
        used = hero.vertices[np.unique(hero.faces)]
        nearest = np.min([farthest_outside(hull, used) for hull in frame.hulls], axis=0)
        self.assertLess(nearest.max(), 1e-6)

    def test_hulls_are_convex_in_every_frame(self):
        for _, frame in zip(range(20), lorica.play("squat_and_reach", self.body)):
            for hull in frame.hulls:
                self.assertLess(farthest_outside(hull, hull.vertices).max(), 1e-6)

    def test_a_files_clips_are_named(self):
        hero = lorica.Character(str(FILES / "hero.glb"))
        self.assertEqual(hero.clips, ["Bow", "Nod"])
        self.assertTrue(any("closed" in note or "surface" in note for note in hero.notes), hero.notes)

    def test_contacts_name_parts_that_are_no_neighbours(self):
        player = lorica.play("punch_and_kick", self.body)
        seen = []
        for _ in player:
            seen += player.contacts()
        self.assertTrue(seen)
        for contact in seen:
            self.assertLess(contact.first, contact.second)
            self.assertGreater(contact.depth, 0)
            self.assertAlmostEqual(np.linalg.norm(contact.direction), 1, 6)
            self.assertEqual(contact.position.shape, (3,))

    def test_touches_of_a_capsule_are_those_of_the_library_bit_for_bit(self):
        player = lorica.play("walk", self.body)
        found = b""
        for _ in zip(range(40), player):
            touches = player.touches([[-1.5, 0.9, 0.1], [0.2, 1.1, -0.1]], radius=0.06)
            found += np.int32(len(touches)).tobytes()
            for touch in touches:
                numbers = np.array([*touch.position, *touch.direction, touch.depth])
                found += np.int32(touch.part).tobytes() + numbers.tobytes()
        self.assertEqual(found, (FILES / "walk_csv.touches").read_bytes())

    def test_rays_enter_the_hulls(self):
        live = self.body.live()
        self.assertEqual(live.cast([0, 1, 3], [0, 0, -1])[0].tolist(), [-1])  # no pose yet
        frame = live.pose(next(lorica.play("walk", self.body)).world_from_joint)
        middles = np.array([hull.vertices.mean(axis=0) for hull in frame.hulls])
        eye = np.array([0.0, 1.0, 3.0])
        parts, distances, positions, normals = live.cast(eye, middles - eye)
        self.assertEqual((parts.dtype, positions.shape), (np.int32, (len(middles), 3)))
        self.assertTrue((parts >= 0).all())
        np.testing.assert_allclose(np.linalg.norm(positions - eye, axis=1), distances, atol=1e-12)
        for part, position, normal in zip(parts, positions, normals):
            hull = frame.hulls[part].vertices
            self.assertAlmostEqual(((hull - position) @ normal).max(), 0, 9)  # on the hull's own plane
        self.assertEqual(live.cast(middles, middles - eye)[1].max(), 0)  # from within
        balls = live.cast(eye, middles - eye, radius=0.05)[1]  # touch before their middles would enter
        self.assertTrue((balls < distances - 0.049).all())
        capsules = live.cast(eye, middles - eye, radius=0.05, half=[0.1, 0, 0])[1]
        self.assertTrue((capsules <= balls + 1e-9).all())
        parts, distances, positions, _ = live.cast([eye, eye], [[0, 0, 1], [np.nan, 0, -1]])
        self.assertEqual((parts.tolist(), distances.tolist()), ([-1, -1], [np.inf, np.inf]))
        self.assertTrue(np.isnan(positions).all())
        self.assertEqual(live.cast(eye, middles - eye, reach=0.5)[0].max(), -1)
        # The same rays meet the skin behind the hulls' faces, where the weights of its posed corners say.
        self.assertEqual(self.body.live().cast_on_skin(eye, middles - eye)[0].max(), -1)  # no pose yet
        triangles, weights, on_skin, points = live.cast_on_skin(eye, middles - eye)
        met = triangles >= 0
        self.assertGreater(met.sum(), len(middles) // 2)
        self.assertTrue((on_skin > live.cast(eye, middles - eye)[1] - 1e-6).all())
        np.testing.assert_allclose(np.linalg.norm(points - eye, axis=1)[met], on_skin[met], atol=1e-12)
        np.testing.assert_allclose(weights[met].sum(axis=1), 1, atol=1e-12)
        self.assertTrue(np.isinf(on_skin[~met]).all() and np.isnan(points[~met]).all())
        self.assertLess(triangles.max(), len(self.body.character.faces))

    def test_parts_move_as_their_points_do(self):
        live = self.body.live()
        player = lorica.play("walk", self.body)
        frames = [live.pose(next(player).world_from_joint) for _ in range(33)]
        now, before, linear, angular = live.motion(0.02)
        self.assertEqual((now.shape, angular.shape), ((len(self.body), 4, 4), (len(self.body), 3)))
        np.testing.assert_allclose((now[:, :3, 3] - before[:, :3, 3]) / 0.02, linear, atol=1e-12)
        for this, last, turn in zip(now[:, :3, :3], before[:, :3, :3], angular * 0.02):
            angle = np.linalg.norm(turn)
            x, y, z = turn / max(angle, 1e-300)
            cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])  # the formula of Rodrigues
            np.testing.assert_allclose((np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross) @ last, this, atol=1e-9)
        self.assertGreater(np.abs(linear).max(), 0.1)
        for swept, *ends in zip(live.swept(), frames[-2].hulls, frames[-1].hulls):
            self.assertLess(max(farthest_outside(swept, end.vertices).max() for end in ends), 1e-9)
            self.assertGreaterEqual(swept.volume, max(end.volume for end in ends) - 1e-12)
        self.assertEqual(len(player.swept()), len(player.motion(0.02)[0]))

    def test_contacts_are_those_of_the_command(self):
        found = lorica.contacts(FILES / "walk.bvh", decomposition=FILES / "body.lorica", scene=FILES / "room.json")
        with np.load(FILES / "contacts.npz") as written:
            self.assertEqual(list(written), list(found))
            for name in written:
                self.assertEqual(written[name].dtype, found[name].dtype)
                np.testing.assert_array_equal(written[name], found[name], name)
        # A shipped recording needs no file.
        self.assertEqual(len(lorica.contacts("walk", decomposition=FILES / "body.lorica")["frame_time"]), 340)
        rows = (FILES / "contacts.csv").read_text().splitlines()
        table = np.array([row.split(",") for row in rows[1:]])
        column = {name: table[:, i] for i, name in enumerate(rows[0].split(","))}
        np.testing.assert_allclose(column["depth"].astype(float), found["depth"], rtol=1e-5, atol=1e-7)
        np.testing.assert_allclose(column["velocity_y"].astype(float), found["velocity"][:, 1], rtol=1e-5, atol=1e-7)
        self.assertEqual(column["bone"].tolist(), found["bones"][found["bone"]].tolist())
        self.assertEqual(column["kind"].tolist(), found["kinds"][found["kind"]].tolist())
        self.assertEqual(column["phase"].tolist(), found["phases"][found["phase"]].tolist())
        self.assertLessEqual({"floor", "prop"}, set(column["kind"]))
        standing = found["frame_standing"]
        self.assertEqual(standing.shape, (len(found["frame_time"]), 1, 2))
        self.assertGreater(standing.any(axis=2).mean(), 0.9)  # who walks has a foot on the floor
        self.assertLess(standing.all(axis=2).mean(), 0.9)
        self.assertTrue((found["depth"] >= -0.05).all())

    def test_a_box_that_moves_out_of_a_touch_only_touches(self):
        live = self.body.live()
        self.assertEqual(live.touches([0, 1, 0], 0.1), [])  # no pose yet
        frame = live.pose(next(lorica.play("walk", self.body)).world_from_joint)
        hips = frame.world_from_joint[0, :3, 3]
        corners = box(hips - 0.1, hips + [0.3, 0.1, 0.1])[0]
        touches = live.touches(corners)
        self.assertTrue(touches)
        for touch in touches:
            hull = frame.hulls[touch.part].vertices
            reach = (hull @ touch.direction).max() - (corners @ touch.direction).min()
            self.assertAlmostEqual(reach, touch.depth, 6)
            out = corners + (touch.depth + 1e-5) * touch.direction
            left = [again.depth for again in live.touches(out) if again.part == touch.part]
            self.assertLess(sum(left), 2e-4)  # the stated accuracy

    def test_a_vertex_limit_holds_in_every_frame(self):
        body = self.mannequin.body(2, hull_vertices=32)
        for _, frame in zip(range(30), lorica.play("punch_and_kick", body)):
            self.assertLessEqual(max(len(hull.vertices) for hull in frame.hulls), 32)

    def test_names_need_not_be_utf8(self):
        with tempfile.TemporaryDirectory() as folder:
            name = os.fsdecode(os.path.join(os.fsencode(folder), b"h\xfclle.glb"))
            shutil.copy(FILES / "hero.glb", name)
            self.assertGreater(lorica.Character(name).height, 0)
            self.assertEqual(lorica.Character(os.fsencode(name)).name, os.fsdecode(b"h\xfclle"))
            none = os.fsdecode(os.path.join(os.fsencode(folder), b"n\xffne.off"))
            for call in (lorica.read_mesh, lorica.load_parts, lorica.Character, lorica.contacts):
                with self.subTest(call), self.assertRaisesRegex((OSError, ValueError), r"n(\udcff|\\xff)ne\.off"):
                    call(none, *box()) if call is lorica.load_parts else call(none)

    def test_bad_input_is_a_sentence(self):
        for error, sentence, call in (
            (FileNotFoundError, "expected mannequin or a character file", lambda: lorica.Character("nobody")),
            (FileNotFoundError, "No such file", lambda: lorica.Character("nobody.glb")),
            (ValueError, "cycle.dae: broken COLLADA: its reader", lambda: lorica.Character(FILES / "cycle.dae")),
            (ValueError, "cycle.dae: broken COLLADA", lambda: lorica.play(FILES / "cycle.dae", self.body)),
            (ValueError, "a mesh without skin", lambda: lorica.Character(FILES / "triangle.dae")),
            (FileNotFoundError, "no shipped recording", lambda: lorica.play("stroll", self.body)),
            (FileNotFoundError, "no clip named Run, expected one of Bow, Nod",
             lambda: lorica.play(FILES / "hero.glb", self.body, clip="Run")),
            (ValueError, "only character files have clips", lambda: lorica.play("walk.csv", self.body, clip="Run")),
            (ValueError, "made from mannequin",
             lambda: lorica.Character(FILES / "hero.glb").load_body(FILES / "body.lorica")),
            (ValueError, "parts: found -1", lambda: self.mannequin.body(-1)),
            (ValueError, "parts: found 2147483647", lambda: self.mannequin.body(2**31 - 1)),
            (ValueError, "threads: found 2147483647", lambda: self.mannequin.body(3, threads=2**31 - 1)),
            (ValueError, "vertices of a hull: found 2", lambda: self.mannequin.body(hull_vertices=2)),
            (ValueError, "cover: found -1", lambda: self.mannequin.body(cover=-1.0)),
            (ValueError, "cover: found 1e-300 m, expected exact, or at least", lambda: self.mannequin.body(cover=1e-300)),
            (ValueError, r"cover: found 1e\+09 m, expected at most", lambda: self.mannequin.body(cover=1e9)),
            (ValueError, r"expected \(52, 4, 4\)", lambda: self.body.live().pose(np.eye(4))),
            (ValueError, "joint 0", lambda: self.body.live().pose(np.full((52, 4, 4), np.nan))),
            (ValueError, "joint 0", lambda: self.body.live().pose(np.zeros((52, 4, 4)))),
            (ValueError, r"points: found shape \(2,\), expected \(n, 3\)", lambda: self.body.live().touches([0, 1])),
            (ValueError, "points: found none", lambda: self.body.live().touches(np.zeros((0, 3)))),
            (ValueError, "point 0: found nan", lambda: self.body.live().touches([np.nan, 1, 0])),
            (ValueError, "origins: found 2, expected 1", lambda: self.body.live().cast(np.eye(3)[:2], np.eye(3))),
            (ValueError, "seconds: found 0", lambda: self.body.live().motion(0)),
            (ValueError, "near: found 2 m, expected 0 to 1 m", lambda: lorica.contacts("walk", near=2)),
            (FileNotFoundError, "none.bvh", lambda: lorica.contacts("none.bvh")),
            (ValueError, "reach: found -1", lambda: self.body.live().cast([0, 1, 0], [0, 0, 1], -1)),
            (ValueError, "radius: found -1", lambda: self.body.live().cast([0, 1, 0], [0, 0, 1], 1, -1)),
            (ValueError, "radius: found -1", lambda: self.body.live().touches([0, 1, 0], -1)),
        ):
            with self.subTest(sentence), self.assertRaisesRegex(error, sentence):
                call()


if __name__ == "__main__":
    unittest.main()
