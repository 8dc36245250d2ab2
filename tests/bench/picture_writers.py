"""One scene in the languages of several renderers, with the same camera, lights and surfaces as far as each can say it.

Knows no clock. POV-Ray: the camera's axes are given outright, so its left-handed habits do not matter. Tachyon is
left-handed, so it gets the scene mirrored in x; it has no index of refraction: its glass does not bend. glTF and Mitsuba:
light falls off and a matte surface reflects albedo / pi, so a lamp of pi d^2 is as bright at the target as the others' lamps.
"""
import json
import math
import struct

import picture_scene


def numbers(v):
    return ",".join(f"{x:.7g}" for x in v)


def spaced(v):
    return " ".join(f"{x:.7g}" for x in v)


def write_pov(scene, path, depth):
    with open(path, "w", encoding="ascii") as out:
        out.write("#version 3.7;\n")
        out.write(f"global_settings {{ assumed_gamma 1.0 max_trace_level {depth} }}\n")
        out.write(f"background {{ rgb <{numbers(scene.background)}> }}\n")
        height = 2.0 * scene.slope
        out.write(f"camera {{ perspective location <{numbers(scene.eye)}> direction <{numbers(scene.forward)}>\n"
                  f"  right <{numbers(picture_scene.scale(scene.right, height))}>"
                  f" up <{numbers(picture_scene.scale(scene.up, height))}> }}\n")
        for light in scene.lights:
            out.write(f"light_source {{ <{numbers(light)}> rgb 1 }}\n")
        for i, m in enumerate(scene.materials):
            out.write(f"#declare M{i} = {pov_material(m)}\n")
        for s, m in zip(scene.spheres, scene.sphere_material):
            out.write(f"sphere {{ <{numbers(s[:3])}>, {s[3]:.7g} material {{ M{m} }} }}\n")
        for m in sorted(set(scene.triangle_material)):
            write_pov_mesh(scene, m, out)


def pov_material(m):
    strength = max(m["specular"])
    finish = f"ambient 0 diffuse 1 specular {strength:.7g} roughness {1.0 / m['shininess']:.7g}"
    if m["glass"]:
        # Fresnel's two branches, as in glint; POV wants energy conserved for that.
        finish = f"ambient 0 diffuse 0.1 specular {strength:.7g} roughness {1.0 / m['shininess']:.7g}"
        return (f"material {{ texture {{ pigment {{ rgbf <1,1,1,1> }} finish {{ {finish} reflection {{ 0, 1 fresnel }}"
                f" conserve_energy }} }} interior {{ ior {m['ior']:.7g} }} }}")
    return (f"material {{ texture {{ pigment {{ rgb <{numbers(m['diffuse'])}> }} finish {{ {finish}"
            f" reflection {{ rgb <{numbers(m['mirror'])}> }} }} }} }}")


def write_pov_mesh(scene, material, out):
    chosen = [t for t, m in scene.each_triangle() if m == material]
    used = {i: k for k, i in enumerate(dict.fromkeys(i for t in chosen for i in t))}
    out.write(f"mesh2 {{ vertex_vectors {{ {len(used)}")
    out.writelines(f",\n<{numbers(scene.vertex(i))}>" for i in used)
    out.write(f" }}\nface_indices {{ {len(chosen)}")
    out.writelines(f",\n<{used[a]},{used[b]},{used[c]}>" for a, b, c in chosen)
    out.write(f" }} material {{ M{material} }} }}\n")


def write_tachyon(scene, path, depth):
    def mirrored(v):
        return spaced([-v[0], v[1], v[2]])

    with open(path, "w", encoding="ascii") as out:
        # Zoom 1 is a window one unit high at distance one.
        out.write("Begin_Scene\nResolution 512 512\nCamera\n"
                  f"  Zoom {0.5 / scene.slope:.7g}\n  Aspectratio 1.0\n  Antialiasing 0\n  Raydepth {depth}\n"
                  f"  Center {mirrored(scene.eye)}\n  Viewdir {mirrored(scene.forward)}\n"
                  f"  Updir {mirrored(scene.up)}\nEnd_Camera\n")
        out.write(f"Background {spaced(scene.background)}\n")
        for light in scene.lights:
            out.write(f"Light Center {mirrored(light)} Rad 0.001 Color 1 1 1\n")
        for i, m in enumerate(scene.materials):
            # Its mirror takes no colour; its glass shows straight through.
            opacity = 0.1 if m["glass"] else 1.0
            mirror = 0.1 if m["glass"] else max(m["mirror"])
            out.write(f"TexDef M{i} Ambient 0 Diffuse 1 Specular {mirror:.7g} Opacity {opacity}\n"
                      f"  Phong Plastic {max(m['specular']):.7g} Phong_size {m['shininess']:.7g}"
                      f" Color {spaced(m['diffuse'])} TexFunc 0\n")
        for s, m in zip(scene.spheres, scene.sphere_material):
            out.write(f"Sphere Center {mirrored(s[:3])} Rad {s[3]:.7g} M{m}\n")
        for (a, b, c), m in scene.each_triangle():
            out.write(f"Tri V0 {mirrored(scene.vertex(a))} V1 {mirrored(scene.vertex(b))} V2 {mirrored(scene.vertex(c))} M{m}\n")
        out.write("End_Scene\n")


def lamp(scene):
    """The radiant intensity of the scene's one light where light falls off."""
    return math.pi * picture_scene.length(picture_scene.subtract(scene.lights[0], scene.target)) ** 2


def write_glb(scene, path):
    """A mesh of one buffer with a primitive for each material, one point light, one camera. No spheres."""
    vertices, views, accessors, primitives = scene.vertices, [], [], []
    axes = [scene.vertices[k::3] for k in range(3)]
    blob = bytearray(vertices.tobytes())
    views.append({"buffer": 0, "byteOffset": 0, "byteLength": len(blob)})
    lo, hi = [[f(a) for a in axes] for f in (min, max)]
    accessors.append({"bufferView": 0, "componentType": 5126, "count": len(vertices) // 3, "type": "VEC3", "min": lo, "max": hi})
    for m in sorted(set(scene.triangle_material)):
        indices = scene.corners(m)
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": 4 * len(indices)})
        accessors.append({"bufferView": len(views) - 1, "componentType": 5125, "count": len(indices), "type": "SCALAR"})
        primitives.append({"attributes": {"POSITION": 0}, "indices": len(accessors) - 1, "material": m})
        blob += indices.tobytes()
    back = picture_scene.scale(scene.forward, -1.0)
    camera_matrix = [*scene.right, 0, *scene.up, 0, *back, 0, *scene.eye, 1]
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": lamp(scene)}]}},
        "nodes": [{"mesh": 0}, {"camera": 0, "matrix": camera_matrix},
                  {"translation": scene.lights[0], "extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": math.radians(scene.angle), "znear": 0.1, "aspectRatio": 1}}],
        "meshes": [{"primitives": primitives}],
        "materials": [{"doubleSided": True, "pbrMetallicRoughness": {"baseColorFactor": [*m["diffuse"], 1], "metallicFactor": 0,
                                                "roughnessFactor": 1}} for m in scene.materials],
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(blob)}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(blob)))
        out.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob)


def write_mitsuba(scene, base, radius):
    """BASE_point.xml and BASE_sphere.xml, and for each material a binary PLY. Direct light only: one ray to the light a sample,
    as in glint, and none in the surface's own directions. The ball of that radius is as bright at a distance as the point."""
    shapes = ""
    for m in sorted(set(scene.triangle_material)):
        mesh = f"{base}_{m}.ply"
        write_ply(scene, m, mesh)
        shapes += (f'<shape type="ply"><string name="filename" value="{mesh}"/><boolean name="face_normals" value="true"/>'
                   f'<bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance"'
                   f' value="{numbers(scene.materials[m]["diffuse"])}"/></bsdf></bsdf></shape>\n')
    place, intensity = numbers(scene.lights[0]), lamp(scene)
    lights = {
        "point": f'<emitter type="point"><point name="position" value="{place}"/>'
                 f'<rgb name="intensity" value="{intensity:.7g}"/></emitter>',
        "sphere": f'<shape type="sphere"><point name="center" value="{place}"/><float name="radius" value="{radius:.7g}"/>'
                  f'<emitter type="area"><rgb name="radiance" value="{intensity / (math.pi * radius * radius):.7g}"/></emitter>'
                  '</shape>'}
    for name, light in lights.items():
        with open(f"{base}_{name}.xml", "w", encoding="ascii") as out:
            out.write(f'<scene version="3.0.0">\n<integrator type="direct"><integer name="emitter_samples" value="1"/>'
                      f'<integer name="bsdf_samples" value="0"/></integrator>\n'
                      f'<sensor type="perspective"><float name="fov" value="{scene.angle:.7g}"/>'
                      f'<string name="fov_axis" value="y"/>\n<transform name="to_world"><lookat origin="{numbers(scene.eye)}"'
                      f' target="{numbers(scene.target)}" up="{numbers(scene.up)}"/></transform>\n'
                      f'<sampler type="independent"/><film type="hdrfilm"><integer name="width" value="512"/>'
                      f'<integer name="height" value="512"/><rfilter type="box"/></film></sensor>\n{light}\n{shapes}</scene>\n')


def write_ply(scene, material, path):
    corners = scene.corners(material).tobytes()
    faces = len(corners) // 12
    # A face: the byte 3, then three numbers of four bytes.
    body = bytearray(b"\3" * (13 * faces))
    for k in range(12):
        body[k + 1::13] = corners[k::12]
    with open(path, "wb") as out:
        out.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(scene.vertices) // 3}\nproperty float x\n"
                  f"property float y\nproperty float z\nelement face {faces}\n"
                  "property list uchar int vertex_indices\nend_header\n".encode())
        out.write(scene.vertices.tobytes())
        out.write(body)
