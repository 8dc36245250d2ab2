"""Matte balls on a floor under one square light, in the languages of glint, Mitsuba and POV-Ray: the scene of time_to_error.

Knows no clock. Direct light only, no mirror, glass or highlight. Models differ a little: glint's P3F and POV-Ray know no
falloff, in Mitsuba light falls off and the square faces down. It lies so far away, and is as large and bright at the middle of
the scene, that the pictures differ by a level or so, and not at all in what is hard about them: penumbras and edges.
"""
import math
import random

import picture_scene
from picture_writers import numbers, spaced

SIZE = 256
EYE, TARGET, UP, ANGLE = [0.0, 5.5, -11.0], [0.0, 0.6, 0.0], [0.0, 1.0, 0.0], 35.0
LIGHT, SIDE = [-360.0, 1200.0, -480.0], 320.0  # the square's middle and side; level
FLOOR, REACH = [0.55, 0.55, 0.55], 60.0


def balls():
    """(x, y, z, radius, colour): one large, the rest strewn around it, none in another."""
    rng, found = random.Random(7), [(0.0, 1.2, 0.0, 1.2, [0.8, 0.75, 0.7])]
    while len(found) < 40:
        r = rng.uniform(0.15, 0.55)
        x, z = rng.uniform(-4.5, 4.5), rng.uniform(-4.5, 4.5)
        y = r + (rng.uniform(0.0, 1.5) if rng.random() < 0.4 else 0.0)
        if all(math.dist((x, y, z), b[:3]) > r + b[3] for b in found):
            found.append((x, y, z, r, [rng.uniform(0.2, 0.9) for _ in range(3)]))
    return found


def write_p3f(path):
    corner = [LIGHT[0] - SIDE / 2, LIGHT[1], LIGHT[2] - SIDE / 2]
    with open(path, "w", encoding="ascii") as out:
        out.write(f"b 0 0 0\nv\nfrom {spaced(EYE)}\nat {spaced(TARGET)}\nup {spaced(UP)}\nangle {ANGLE}\nhither 0.01\n"
                  f"resolution {SIZE} {SIZE}\n"
                  f"light quad {spaced(corner)} 1 1 1 {spaced([corner[0] + SIDE, *corner[1:]])}"
                  f" {spaced([*corner[:2], corner[2] + SIDE])} 1\n")
        out.write(f"f {spaced(FLOOR)} 1 0 1 0 1\n"
                  f"p 4\n{-REACH} 0 {-REACH}\n{-REACH} 0 {REACH}\n{REACH} 0 {REACH}\n{REACH} 0 {-REACH}\n")
        for x, y, z, r, color in balls():
            out.write(f"f {spaced(color)} 1 0 1 0 1\ns {spaced([x, y, z, r])}\n")


def write_pov(path, light_grid, options):
    """light_grid: points along a side of the light; options: more words of its area_light."""
    forward = picture_scene.unit(picture_scene.subtract(TARGET, EYE))
    # As glint turns its pictures: right = forward x up.
    right = picture_scene.unit(picture_scene.cross(forward, UP))
    up = picture_scene.cross(right, forward)
    height = 2.0 * math.tan(math.radians(ANGLE) / 2.0)
    with open(path, "w", encoding="ascii") as out:
        out.write("#version 3.7;\nglobal_settings { assumed_gamma 1.0 max_trace_level 1 }\nbackground { rgb 0 }\n"
                  f"camera {{ perspective location <{numbers(EYE)}> direction <{numbers(forward)}>\n"
                  f"  right <{numbers(picture_scene.scale(right, height))}> up <{numbers(picture_scene.scale(up, height))}> }}\n"
                  f"light_source {{ <{numbers(LIGHT)}> rgb 1 area_light <{SIDE},0,0>, <0,0,{SIDE}>,"
                  f" {light_grid}, {light_grid} {options} }}\n")

        def matte(color):
            return f"texture {{ pigment {{ rgb <{numbers(color)}> }} finish {{ ambient 0 diffuse 1 }} }}"

        out.write(f"mesh2 {{ vertex_vectors {{ 4, <{-REACH},0,{-REACH}>, <{-REACH},0,{REACH}>, <{REACH},0,{REACH}>,"
                  f" <{REACH},0,{-REACH}> }} face_indices {{ 2, <0,1,2>, <0,2,3> }} {matte(FLOOR)} }}\n")
        for x, y, z, r, color in balls():
            out.write(f"sphere {{ <{numbers([x, y, z])}>, {r:.7g} {matte(color)} }}\n")


def write_mitsuba(path, sampler):
    distance = picture_scene.subtract(LIGHT, TARGET)
    square = sum(x * x for x in distance)
    # Matte surfaces reflect albedo / pi; the light's own cosine is that at the middle of the scene.
    radiance = math.pi * square / (SIDE * SIDE * distance[1] / math.sqrt(square))

    def matte(color):
        return f'<bsdf type="diffuse"><rgb name="reflectance" value="{numbers(color)}"/></bsdf>'

    shapes = (f'<shape type="rectangle"><transform name="to_world"><scale value="{SIDE / 2}"/><rotate x="1" angle="90"/>'
              f'<translate value="{numbers(LIGHT)}"/></transform><emitter type="area">'
              f'<rgb name="radiance" value="{radiance:.7g}"/></emitter></shape>\n'
              f'<shape type="rectangle"><transform name="to_world"><scale value="{REACH}"/><rotate x="1" angle="-90"/>'
              f'</transform>{matte(FLOOR)}</shape>\n')
    for x, y, z, r, color in balls():
        shapes += (f'<shape type="sphere"><point name="center" value="{numbers([x, y, z])}"/>'
                   f'<float name="radius" value="{r:.7g}"/>{matte(color)}</shape>\n')
    with open(path, "w", encoding="ascii") as out:
        out.write('<scene version="3.0.0">\n<integrator type="direct"><integer name="emitter_samples" value="1"/>'
                  '<integer name="bsdf_samples" value="0"/></integrator>\n'
                  f'<sensor type="perspective"><float name="fov" value="{ANGLE}"/><string name="fov_axis" value="y"/>\n'
                  f'<transform name="to_world"><lookat origin="{numbers(EYE)}" target="{numbers(TARGET)}" up="{numbers(UP)}"/>'
                  f'</transform>\n<sampler type="{sampler}"/><film type="hdrfilm"><integer name="width" value="{SIZE}"/>'
                  f'<integer name="height" value="{SIZE}"/><rfilter type="box"/></film></sensor>\n{shapes}</scene>\n')
