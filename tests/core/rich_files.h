// Small files that use all that a reader follows, so that damage to them reaches all of it.
// Knows no test.
#pragma once

#include <string_view>

#include "tests/core/gltf_fixture.h"

namespace glint::test {

// One of everything, so that mutations reach each statement.
inline constexpr std::string_view kEveryStatement =
    "# all words\naccel bvh\nspp 4\nbclr 0.1 0.2 0.3\nenv skybox\nfire skybox\ncamera\neye 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\n"
    "hither 0.01\nresolution 64 48\naperture 2\nfocal 1.5\ntime0 0\nl 1 2 3 1 1 1\nlight punctual 4 5 6 1 1 1\n"
    "light quad 1 2 3 1 1 1 2 2 3 1 2 4 16\nal 1 2 3 0 -1 0 1 1 1 1 1\nf 1 0.5 0.5 0.5 0.5 10 0 1\ns 0 0 0 1\n"
    "mat 1 1 1 0 1 1 1 0.2 20 1 1.35\nbox 0 0 0 1 1 1\naabb 1 1 1 0 0 0\npl 0 0 0 1 0 0 0 1 0\nnpl 0 0 1 2\n"
    "p 5 0 0 0 2 0 0 2 2 0 1 1 0 0 2 0\npp 3 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1\n"
    "mesh 4 2\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n1 2 3\n-1 -2 1\nc 0 0 0 1 0 0 2 0.5\nms 0 0 0 1 1 1 0.5 0 1\n"
    "sm 0 0 0 1 1 1 0.5 0 1\na 0 0 0 1 1 1 10\nxyzzy 1 2 3\nply mesh.ply\n";

// A glTF document of nodes, cameras, lights and materials around `triangle`, its buffer to be put into a GLB.
inline json rich_document(const json& triangle) {
    json d = triangle;
    d["buffers"][0].erase("uri");
    d["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}},
                    {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 9}}}}};
    d["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 5}},
                                                        {{"type", "spot"}, {"spot", {{"outerConeAngle", 0.5}}}}};
    d["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_ior"};
    d["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.5, 0, 1}}, {"metallicFactor", 0.5}}},
                       {"emissiveFactor", {0, 0, 1}},
                       {"extensions", {{"KHR_materials_ior", {{"ior", 1.33}}}}}}};
    d["meshes"][0]["primitives"][0]["material"] = 0;
    d["nodes"] = {{{"children", {1, 2, 3}}, {"scale", {-1, 2, 1}}},
                  {{"mesh", 0}, {"rotation", {0, 0.6, 0, 0.8}}, {"camera", 0}},
                  {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}}, {"camera", 1}},
                  {{"translation", {0, 3, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}}};
    d["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 36}, {"byteLength", 8}});
    d["accessors"][0]["sparse"] = {{"count", 1},
                                   {"indices", {{"bufferView", 2}, {"byteOffset", 4}, {"componentType", 5123}}},
                                   {"values", {{"bufferView", 0}, {"byteOffset", 24}}}};
    return d;
}

}  // namespace glint::test
