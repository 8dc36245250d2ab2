"""Scenes for the comparison of whole pictures: what scene_dump says, and a mesh on a floor made from it.

Knows no renderer. Right-handed, as glint is. Lights are points without falloff.
"""
import array
import json
import math
import os
import subprocess


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def scale(a, k):
    return [x * k for x in a]


def subtract(a, b):
    return add(a, scale(b, -1.0))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def length(a):
    return math.sqrt(sum(x * x for x in a))


def unit(a):
    return scale(a, 1.0 / length(a))


class Scene:
    """vertices, triangles and triangle_material as flat arrays; spheres, materials, lights, background as scene_dump lists
    them; camera as unit axes."""

    def __init__(self, dump, arrays, name):
        self.name = name
        self.vertices, self.triangles, self.triangle_material = array.array("f"), array.array("I"), array.array("I")
        for values, count in ((self.vertices, 3 * dump["vertices"]), (self.triangles, 3 * dump["triangles"]),
                              (self.triangle_material, dump["triangles"])):
            values.fromfile(arrays, count)
        self.spheres, self.materials, self.sphere_material = dump["spheres"], dump["materials"], dump["sphere_material"]
        self.lights, self.background = dump["lights"], dump["background"]
        self.look(dump["camera"])

    def look(self, camera):
        self.eye, self.target, self.angle = camera["eye"], camera["target"], camera["angle"]
        self.forward = unit(subtract(self.target, self.eye))
        self.right = unit(cross(self.forward, camera["up"]))
        self.up = cross(self.right, self.forward)
        # Half the height of the picture at distance 1.
        self.slope = math.tan(math.radians(self.angle) / 2.0)

    def vertex(self, i):
        return self.vertices[3 * i:3 * i + 3]

    def each_triangle(self):
        for i, material in enumerate(self.triangle_material):
            yield self.triangles[3 * i:3 * i + 3], material

    def corners(self, material):
        """The vertex numbers of all triangles of a material, as one flat array."""
        return array.array("I", (i for t, m in self.each_triangle() if m == material for i in t))


def load(dump_program, source, name, path):
    """None, with the program's own line on stderr, where the scene is not to be had. `path`: a file to use and remove."""
    result = subprocess.run([dump_program, source, path], stdout=subprocess.PIPE, check=False)
    if result.returncode != 0:
        return None
    with open(path, "rb") as arrays:
        scene = Scene(json.loads(result.stdout), arrays, name)
    os.remove(path)
    return scene


def matte(color):
    return {"diffuse": color, "specular": [0, 0, 0], "shininess": 1, "mirror": [0, 0, 0], "glass": False, "ior": 1}


def on_a_floor(scene):
    """The mesh scaled to a diagonal of 100 on a large matte floor under one light; no mirrors, no highlights."""
    # Meshes come on a stage of another material, which goes.
    corners = scene.corners(scene.triangle_material[0])
    used = sorted(set(corners))
    number = {i: k for k, i in enumerate(used)}
    axes = [[scene.vertices[3 * i + k] for i in used] for k in range(3)]
    lo, hi = [min(a) for a in axes], [max(a) for a in axes]
    middle, size = scale(add(lo, hi), 0.5), 100.0 / length(subtract(hi, lo))
    scene.vertices = array.array("f", bytes(12 * len(used)))
    for k in range(3):
        scene.vertices[k::3] = array.array("f", ((x - middle[k]) * size for x in axes[k]))
    floor, reach, first = (lo[1] - middle[1]) * size, 300.0, len(used)
    for x, z in ((-reach, -reach), (reach, -reach), (-reach, reach), (reach, reach)):
        scene.vertices.extend([x, floor, z])
    scene.triangles = array.array("I", (number[i] for i in corners))
    scene.triangle_material = array.array("I", bytes(4 * (len(corners) // 3)))
    scene.triangles.extend([first, first + 2, first + 1, first + 1, first + 2, first + 3])
    scene.triangle_material.extend([1, 1])
    scene.materials = [matte([0.7, 0.6, 0.5]), matte([0.5, 0.5, 0.5])]
    scene.lights = [[-60.0, 150.0, 90.0]]
    scene.background = [0.0, 0.0, 0.0]  # glTF knows none
    eye = scale(unit([0.35, 0.3, 1.0]), 200.0)
    scene.look({"eye": eye, "target": [0.0, 0.0, 0.0], "up": [0.0, 1.0, 0.0], "angle": 28.0})
    return scene
