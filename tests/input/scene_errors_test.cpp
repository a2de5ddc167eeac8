#include <catch2/catch.hpp>

#include <fstream>
#include <string>
#include <vector>

#include "run_castray.h"
#include "temporary_folder.h"

namespace {

struct File {
  std::string name, content;
};

/// A faulty input and what must be said about it, behind "castray: error: ".
struct Case {
  std::string what;
  std::vector<File> files;  ///< the first is the scene
  std::string message;
};

const File good_obj{"good.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"};

/// A scene whose line 2 is `line`.
File scene_with(const std::string& line) {
  return {"s.json", "{\n" + line + "\n  \"meshes\": [ { \"obj\": \"good.obj\" } ]\n}\n"};
}

File scene_with_mesh(const std::string& mesh) {
  return {"s.json", "{\n  \"materials\": { \"white\": { \"type\": \"diffuse\" } },\n  \"meshes\": [\n    " +
                        mesh + "\n  ]\n}\n"};
}

Case in_line(const std::string& what, const std::string& line, const std::string& message) {
  return {what, {scene_with(line), good_obj}, message};
}

Case in_mesh(const std::string& what, const std::string& mesh, const std::string& message) {
  return {what, {scene_with_mesh(mesh), good_obj}, message};
}

Case in_instances(const std::string& what, const std::string& instance, const std::string& transforms,
                  const std::string& message) {
  return {what,
          {{"s.json", "{\n  \"objects\": { \"tree\": [ { \"obj\": \"good.obj\" } ] },\n  \"instances\": [ " +
                          instance + " ]\n}\n"},
           good_obj,
           {"t.txt", transforms}},
          message};
}

Case in_obj(const std::string& what, const std::string& obj, const std::string& message) {
  return {what, {{"o.obj", obj}}, message};
}

Case in_mtl(const std::string& what, const std::string& mtl, const std::string& message) {
  return {what,
          {{"o.obj", "mtllib o.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}, {"o.mtl", mtl}},
          message};
}

const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

const std::vector<Case> cases = {
    // JSON syntax
    {"empty file",
     {{"s.json", ""}},
     "s.json:1:1: not valid JSON: syntax error while parsing value - unexpected end of input; expected '[', "
     "'{', or a literal"},
    in_line("unclosed string", R"(  "camera)",
            "s.json:2:10: not valid JSON: syntax error while parsing object key - invalid string: control "
            "character U+000A (LF) must be escaped to \\u000A or \\n; last read: '\"camera<U+000A>'; "
            "expected string literal"),
    in_line("missing comma", R"(  "image": {})",
            "s.json:3:10: not valid JSON: syntax error while parsing object - unexpected string literal; "
            "expected '}'"),
    in_line("a number too large", R"(  "image": { "width": 1e999 },)",
            "s.json:2:27: not valid JSON: number overflow parsing '1e999'"),
    {"cut short",
     {{"s.json", "{ \"meshes\": ["}},
     "s.json:1:14: not valid JSON: syntax error while parsing value - unexpected end of input; expected '[', "
     "'{', or a literal"},
    {"more behind the end",
     {{"s.json", "{} {}"}},
     "s.json:1:4: not valid JSON: syntax error while parsing value - unexpected '{'; expected end of input"},
    {"not an object", {{"s.json", "[1, 2]"}}, "s.json:1:1: the scene must be an object, not an array"},
    // Keys
    in_line("unknown key", R"(  "camra": {},)",
            "s.json:2:3: unknown key 'camra' in the scene; did you mean 'camera'?"),
    in_line("unknown key, behind a comment", R"(  /* "x" { */ "camra": {},)",
            "s.json:2:15: unknown key 'camra' in the scene; did you mean 'camera'?"),
    in_line("unknown key, behind comments whose lines end in CR", "// a \"\r// b\r  \"camra\": {},",
            "s.json:2:15: unknown key 'camra' in the scene; did you mean 'camera'?"),
    in_line("key twice", R"(  "image": {}, "image": {},)", "s.json:2:16: 'image' is there twice; remove one"),
    in_line("unknown camera key", R"(  "camera": { "fow": 40 },)",
            "s.json:2:15: unknown key 'fow' in \"camera\"; did you mean 'fov'?"),
    {"no meshes", {{"s.json", "{}"}}, "s.json:1:1: the scene needs the key 'meshes'"},
    // Lights
    in_line("light without a type", R"(  "lights": [ { "position": [0,0,1] } ],)",
            "s.json:2:15: a light needs the key 'type'"),
    in_line(
        "point light with a direction",
        R"(  "lights": [ { "type": "point", "position": [0,0,1], "direction": [0,0,1], "intensity": [1,1,1] } ],)",
        "s.json:2:55: \"direction\" is not of a point light"),
    in_line(
        "spot that is wider inside than outside",
        R"(  "lights": [ { "type": "spot", "position": [0,0,1], "look_at": [0,0,0], "intensity": [1,1,1], "outer_angle": 20, "inner_angle": 20 } ],)",
        "s.json:2:130: \"inner_angle\" must be at least 0 and less than 20, not 20"),
    in_line(
        "spot that looks at itself",
        R"(  "lights": [ { "type": "spot", "position": [0,0,1], "look_at": [0,0,1], "intensity": [1,1,1] } ],)",
        "s.json:2:65: the light's direction must not be (0,0,0)"),
    // Camera
    in_line("orthographic camera without height",
            R"(  "camera": { "type": "orthographic", "position": [0,0,1], "look_at": [0,0,0] },)",
            "s.json:2:13: \"camera\" needs the key 'height'"),
    in_line("height of a perspective",
            R"(  "camera": { "height": 2, "position": [0,0,1], "look_at": [0,0,0] },)",
            "s.json:2:15: \"height\" goes with \"type\": \"orthographic\" only"),
    in_line("lens of a panorama",
            R"(  "camera": { "type": "panorama", "position": [0,0,1], "look_at": [0,0,0], "lens": {} },)",
            "s.json:2:76: \"lens\" goes with \"type\": \"perspective\" only"),
    in_line("unknown type of camera",
            R"(  "camera": { "type": "perspectiv", "position": [0,0,1], "look_at": [0,0,0] },)",
            "s.json:2:23: unknown \"type\" 'perspectiv'; did you mean 'perspective'?"),
    in_line("lens without a size", R"(  "camera": { "position": [0,0,1], "look_at": [0,0,0], "lens": {} },)",
            "s.json:2:64: \"lens\" needs \"radius\" or \"f_number\", one of them"),
    in_line("f-number without a sensor",
            R"(  "camera": { "position": [0,0,1], "look_at": [0,0,0], "lens": { "f_number": 2 } },)",
            "s.json:2:64: \"lens\" needs the key 'sensor_height'"),
    in_line(
        "two blades",
        R"(  "camera": { "position": [0,0,1], "look_at": [0,0,0], "lens": { "radius": 2, "blades": 2 } },)",
        "s.json:2:89: \"blades\" must be at least 3 and at most 64, not 2"),
    in_line(
        "focus behind the camera",
        R"(  "camera": { "position": [0,0,1], "look_at": [0,0,0], "lens": { "radius": 2, "focus_on": [0,0,2] } },)",
        "s.json:2:91: \"focus_on\" must lie in front of the camera"),
    in_line("camera without look_at", R"(  "camera": { "position": [0,0,0] },)",
            "s.json:2:13: \"camera\" needs the key 'look_at'"),
    in_line("position of two numbers", R"(  "camera": { "position": [0,0], "look_at": [0,0,1] },)",
            "s.json:2:27: \"position\" must be an array of 3 numbers, but has 2"),
    in_line("position with a string", R"(  "camera": { "position": [0,0,"x"], "look_at": [0,0,1] },)",
            "s.json:2:32: \"position\"[2] must be a number, not a string"),
    in_line(
        "position with NaN", R"(  "camera": { "position": [0,0,NaN], "look_at": [0,0,1] },)",
        "s.json:2:32: not valid JSON: syntax error while parsing value - invalid literal; last read: '0,N'"),
    in_line("position beyond double's range",
            R"(  "camera": { "position": [0,0,1e999], "look_at": [0,0,1] },)",
            "s.json:2:36: not valid JSON: number overflow parsing '1e999'"),
    in_line("look_at = position", R"(  "camera": { "position": [0,0,1], "look_at": [0,0,1] },)",
            "s.json:2:13: the camera's look_at must differ from its position"),
    in_line("up along the view", R"(  "camera": { "position": [0,0,0], "look_at": [0,2,0] },)",
            "s.json:2:13: the camera's up must not be parallel to its view direction"),
    in_line("up is zero", R"(  "camera": { "position": [0,0,0], "look_at": [0,2,0], "up": [0,0,0] },)",
            "s.json:2:13: the camera's up must not be (0,0,0)"),
    in_line("fov 0", R"(  "camera": { "position": [0,0,0], "look_at": [0,0,1], "fov": 0 },)",
            "s.json:2:63: \"fov\" must be at least 1e-05 and less than 180, not 0"),
    in_line("fov 180", R"(  "camera": { "position": [0,0,0], "look_at": [0,0,1], "fov": 180.0 },)",
            "s.json:2:63: \"fov\" must be at least 1e-05 and less than 180, not 180.0"),
    // Image, render, environment
    in_line("width 0", R"(  "image": { "width": 0 },)",
            "s.json:2:23: \"width\" must be at least 1 and at most 65536, not 0"),
    in_line("width with a fraction", R"(  "image": { "width": 10.5 },)",
            "s.json:2:23: \"width\" must be a whole number, not 10.5"),
    in_line("too many pixels", R"(  "image": { "width": 65536, "height": 65536 },)",
            "s.json:2:12: 65536 x 65536 pixels are too many; at most 268435456 in all"),
    in_line("render is no object", R"(  "render": 7,)",
            "s.json:2:13: \"render\" must be an object, not a number"),
    in_line("a flag that is an object", R"(  "render": { "spp": {} },)",
            "s.json:2:22: \"spp\" must be a flag's value, not an object"),
    in_line("radiance that floats do not hold", R"(  "environment": { "radiance": 1e300 },)",
            "s.json:2:32: \"radiance\" must be 0, or at least 1e-30 and at most 1e+30, not 1e300"),
    in_line("radiance that floats lose", R"(  "environment": { "radiance": [1, 1, 1e-40] },)",
            "s.json:2:39: \"radiance\"[2] must be 0, or at least 1e-30 and at most 1e+30, not 1e-40"),
    in_line("a gradient that floats do not hold",
            R"(  "environment": { "gradient": { "zenith": 1e39, "horizon": 1 } },)",
            "s.json:2:44: \"zenith\" must be 0, or at least 1e-30 and at most 1e+30, not 1e39"),
    in_line("a factor of the environment that floats do not hold",
            R"(  "environment": { "gradient": { "zenith": 1, "horizon": 1 }, "scale": 1e39 },)",
            "s.json:2:72: \"scale\" must be 0, or at least 1e-30 and at most 1e+30, not 1e39"),
    in_line("an environment that its factor makes too bright",
            R"(  "environment": { "gradient": { "zenith": 1e20, "horizon": 1 }, "scale": 1e15 },)",
            "s.json: images make radiance as great as 1e+35; it must be 0, or at least 1e-30 and at "
            "most "
            "1e+30"),
    in_line("emission that floats do not hold",
            R"(  "materials": { "a": { "type": "diffuse", "ke": 1e300 } },)",
            "s.json:2:50: \"ke\" must be 0, or at least 1e-30 and at most 1e+30, not 1e300"),
    in_line("an index that Fresnel's equations do not take",
            R"(  "materials": { "a": { "type": "conductor", "reflectance": { "eta": 1, "k": 1e10 } } },)",
            "s.json:2:78: \"k\" must be at least 0 and at most 10000, not 1e10"),
    in_line("a light that floats do not hold",
            R"(  "lights": [ { "type": "directional", "direction": [0,0,1], "irradiance": [1, 1, 1e39] } ],)",
            "s.json:2:83: \"irradiance\"[2] must be 0, or at least 1e-30 and at most 1e+30, not 1e39"),
    in_line("a light that is too bright for its scene",
            R"(  "lights": [ { "type": "point", "position": [0,0,1], "intensity": [1, 1, 1e39] } ],)",
            "s.json: lights[0]: intensity / d^2 is 4e+39 where d, 0.5, is the size of the scene; it must be "
            "0, or at "
            "least 1e-30 and at most 1e+30"),
    in_line("a camera that is out of reach",
            R"(  "camera": { "position": [0, 0, 1e200], "look_at": [0, 0, 0] },)",
            "s.json:2:34: \"position\"[2] must be at least -1e+100 and at most 1e+100, not 1e200"),
    in_line("a lens that is out of reach",
            R"(  "camera": { "position": [0, 0, 1], "look_at": [0, 0, 0], "lens": { "radius": 1e-200 } },)",
            "s.json:2:80: \"radius\" must be at least 1e-100 and at most 1e+100, not 1e-200"),
    in_line("negative radiance", R"(  "environment": { "radiance": [0,-1,0] },)",
            "s.json:2:35: \"radiance\"[1] must be 0, or at least 1e-30 and at most 1e+30, not -1"),
    in_line("radiance and an image", R"(  "environment": { "radiance": [1,1,1], "image": "sky.hdr" },)",
            "s.json:2:41: \"radiance\" or \"image\", not both; \"scale\" makes an image brighter"),
    in_line("sun below the horizon", R"(  "environment": { "sky": { "sun_elevation": -5 } },)",
            "s.json:2:46: \"sun_elevation\" must be at least 0 and at most 90, not -5"),
    in_line("gradient without a zenith", R"(  "environment": { "gradient": { "horizon": 1 } },)",
            "s.json:2:32: \"gradient\" needs the key 'zenith'"),
    // Materials
    in_line("material without type", R"(  "materials": { "a": { "kd": [1,1,1] } },)",
            "s.json:2:23: material 'a' needs the key 'type'"),
    in_line("a pair without a back", R"(  "materials": { "a": { "type": "two_sided", "front": "b" } },)",
            "s.json:2:23: material 'a' (two_sided) needs the key 'back'"),
    in_line(
        "a side that is not there",
        R"(  "materials": { "sky": { "type": "diffuse" }, "a": { "type": "two_sided", "front": "sky", "back": "ski" } },)",
        "s.json:2:100: material 'ski' not found; did you mean 'sky'?"),
    in_line("a number as a side",
            R"(  "materials": { "a": { "type": "two_sided", "front": 1, "back": 2 } },)",
            "s.json:2:55: \"front\" must be a material or its name, not a number"),
    in_line("a pair of a pair",
            R"(  "materials": { "a": { "type": "two_sided", "front": "a", "back": "a" } },)",
            "s.json:2:55: \"front\" cannot be a pair itself"),
    in_line(
        "a pair in a pair",
        R"(  "materials": { "a": { "type": "two_sided", "front": { "type": "two_sided" }, "back": "a" } },)",
        "s.json:2:55: \"front\" cannot be a pair itself"),
    in_line(
        "glass on one side",
        R"(  "materials": { "a": { "type": "two_sided", "front": { "type": "diffuse" }, "back": { "type": "dielectric" } } },)",
        "s.json:2:86: \"back\" cannot be glass, through which light gets to the other side"),
    in_line(
        "a back that emits on both",
        R"(  "materials": { "a": { "type": "two_sided", "front": { "type": "diffuse" }, "back": { "type": "diffuse", "ke": 1, "two_sided_emission": true } } },)",
        "s.json:2:86: \"back\" of a pair cannot emit on both sides: each emits on its own"),
    in_line(
        "a side that emits on both",
        R"(  "materials": { "l": { "type": "diffuse", "ke": 1, "two_sided_emission": true }, "a": { "type": "two_sided", "front": "l", "back": { "type": "diffuse" } } },)",
        "s.json:2:120: \"front\" of a pair cannot emit on both sides: each emits on its own"),
    in_line(
        "sides of which not the same share is there",
        R"(  "materials": { "a": { "type": "two_sided", "front": { "type": "diffuse", "coverage": 0.5 }, "back": { "type": "diffuse" } } },)",
        "s.json:2:103: \"front\" and \"back\" must have the same \"coverage\""),
    in_line("unknown type", R"(  "materials": { "a": { "type": "difuse" } },)",
            "s.json:2:33: unknown material type 'difuse'; did you mean 'diffuse'?"),
    in_line("a key of no type",
            R"(  "materials": { "a": { "type": "diffuse", "two_sided_emissiontype": 1 } },)",
            "s.json:2:44: unknown key 'two_sided_emissiontype' in material 'a'; did you mean "
            "'two_sided_emission'?"),
    in_line("key of another type", R"(  "materials": { "a": { "type": "diffuse", "ks": [1,1,1] } },)",
            "s.json:2:44: unknown key 'ks' in material 'a' (diffuse); did you mean 'kd'?"),
    in_line("an unknown metal",
            R"(  "materials": { "a": { "type": "conductor", "reflectance": "aluminum" } },)",
            "s.json:2:61: unknown metal 'aluminum'; did you mean 'aluminium'?"),
    in_line(
        "a lamp that is glass in part",
        R"(  "materials": { "a": { "type": "principled", "transmission": 0.5, "ke": 2 } },)",
        "s.json:2:68: \"ke\" cannot go with \"transmission\"; give a part of the mesh a material of its own"),
    in_line(
        "a rough thin wall",
        R"(  "materials": { "a": { "type": "dielectric", "thin": true, "roughness": 0.2 } },)",
        "s.json:2:61: \"roughness\" cannot go with \"thin\": a thin wall is smooth, and has no inside; tint "
        "what passes by \"transmittance\""),
    in_line(
        "brushed metal with tables of round lobes",
        R"(  "materials": { "a": { "type": "conductor", "anisotropy": 0.5, "multiple_scattering": true } },)",
        "s.json:2:46: \"anisotropy\" cannot go with \"multiple_scattering\", whose tables are of round "
        "lobes; leave one of them out"),
    in_line("layers with a brushed lobe that emit",
            R"(  "materials": { "a": { "type": "principled", "anisotropy": 0.5, "ke": 2 } },)",
            "s.json:2:66: \"ke\" cannot go with \"anisotropy\" of a principled material; give a part of the "
            "mesh a material of its own"),
    in_line("a grey above 1", R"(  "materials": { "a": { "type": "diffuse", "kd": 1.5 } },)",
            "s.json:2:50: \"kd\" must be at least 0 and at most 1, not 1.5"),
    in_line("an index without its imaginary part",
            R"(  "materials": { "a": { "type": "conductor", "reflectance": { "eta": 1 } } },)",
            "s.json:2:61: \"reflectance\" needs the key 'k'"),
    in_line("an index below 0",
            R"(  "materials": { "a": { "type": "conductor", "reflectance": { "eta": 1, "k": -1 } } },)",
            "s.json:2:78: \"k\" must be at least 0 and at most 10000, not -1"),
    in_line("an index of a lamp",
            R"(  "materials": { "a": { "type": "diffuse", "ke": { "eta": 1, "k": 2 } } },)",
            "s.json:2:52: unknown key 'eta' in \"ke\"; known: image, factor, scale, offset, clamp, channel, "
            "color_space, base, gain, filter"),
    in_line(
        "glass that lets nothing pass",
        R"(  "materials": { "a": { "type": "dielectric", "absorption": { "color": [0,1,1], "distance": 2 } } },)",
        "s.json:2:73: \"color\"[0] must be greater than 0 and at most 1, not 0"),
    in_line("what is left of light after no distance",
            R"(  "materials": { "a": { "type": "dielectric", "absorption": { "color": 0.5 } } },)",
            "s.json:2:61: \"absorption\" needs the key 'distance'"),
    in_line(
        "a sun that has set",
        R"(  "environment": { "sky": { "time": "2024-06-21T23:30Z", "latitude": 40, "longitude": 0 } },)",
        "s.json:2:37: the sun is 26.1 degrees below the horizon then, at this latitude and longitude; choose "
        "another time"),
    in_line("no time", R"(  "environment": { "sky": { "time": "noon", "latitude": 40, "longitude": 0 } },)",
            "s.json:2:37: \"time\" is one from 1900 to 2100 as \"2024-06-21T12:00Z\" or "
            "\"2024-06-21T14:00+02:00\""),
    in_line(
        "a sun by time and by angle",
        R"(  "environment": { "sky": { "time": "2024-06-21T12:00Z", "sun_azimuth": 3, "latitude": 4, "longitude": 0 } },)",
        "s.json:2:58: \"sun_azimuth\" or \"longitude\", not both: they place the sun"),
    in_line("a metal's name for a lamp", R"(  "materials": { "a": { "type": "diffuse", "ke": "gold" } },)",
            "s.json:2:50: \"ke\" must be an array of 3 numbers, not a string"),
    in_line("kd above 1", R"(  "materials": { "a": { "type": "diffuse", "kd": [1,1.5,1] } },)",
            "s.json:2:53: \"kd\"[1] must be at least 0 and at most 1, not 1.5"),
    in_line("alpha and roughness",
            R"(  "materials": { "a": { "type": "conductor", "alpha": 0.1, "roughness": 0.1 } },)",
            "s.json:2:60: give \"roughness\" or \"alpha\" (= roughness^2), not both"),
    in_line("ior 0", R"(  "materials": { "a": { "type": "dielectric", "ior": 0 } },)",
            "s.json:2:54: \"ior\" must be greater than 0 and at most 10000, not 0"),
    in_line("two_sided_emission is a string",
            R"(  "materials": { "a": { "type": "diffuse", "two_sided_emission": "yes" } },)",
            "s.json:2:66: \"two_sided_emission\" must be true or false, not a string"),
    in_line("a parameter's image that is not there",
            R"(  "materials": { "a": { "type": "diffuse", "kd": { "image": "gone.png" } } },)",
            "s.json:2:61: no such file: gone.png"),
    in_line("a parameter's object without an image",
            R"(  "materials": { "a": { "type": "diffuse", "kd": { "scale": [2,2] } } },)",
            "s.json:2:50: \"kd\" needs the key 'image'"),
    in_line(
        "unknown channel",
        R"(  "materials": { "a": { "type": "conductor", "alpha": { "image": "s.json", "channel": "rot" } } },)",
        "s.json:2:87: unknown channel 'rot'; known: color, red, green, blue, alpha, luminance"),
    in_line(
        "a factor of a normal map",
        R"(  "materials": { "a": { "type": "diffuse", "normal_map": { "image": "s.json", "factor": 2 } } },)",
        "s.json:2:79: \"normal_map\" has no factor; use \"gain\""),
    in_line(
        "unknown filter",
        R"(  "materials": { "a": { "type": "diffuse", "kd": { "image": "s.json", "filter": "pixels" } } },)",
        "s.json:2:81: unknown filter 'pixels'; did you mean 'pixel'?"),
    in_line(
        "a filter of a number",
        R"(  "materials": { "a": { "type": "conductor", "alpha": { "image": "s.json", "filter": "pixel" } } },)",
        "s.json:2:76: \"alpha\" cannot be filtered: only colours of what is reflected or transmitted; leave "
        "\"filter\" out"),
    in_line(
        "a filter of a lamp",
        R"(  "materials": { "a": { "type": "diffuse", "ke": { "image": "s.json", "filter": "pixel" } } },)",
        "s.json:2:71: \"ke\" cannot be filtered: only colours of what is reflected or transmitted; leave "
        "\"filter\" out"),
    in_line("an index of refraction cannot be an image",
            R"(  "materials": { "a": { "type": "dielectric", "ior": { "image": "s.json" } } },)",
            "s.json:2:54: \"ior\" must be a number, not an object"),
    // Meshes
    in_mesh("material not found", R"({ "obj": "good.obj", "material": "whit" })",
            "s.json:4:38: material 'whit' not found; did you mean 'white'?"),
    in_mesh("a zero byte in a name", R"({ "obj": "good.obj\u0000x" })",
            "s.json:4:14: \"obj\" must not hold a zero byte"),
    in_mesh("missing OBJ file", R"({ "obj": "gone.obj" })", "s.json:4:14: no such file: gone.obj"),
    in_mesh("OBJ is a folder", R"({ "obj": "." })", "s.json:4:14: a folder, not a file: ."),
    in_mesh("scale 0", R"({ "obj": "good.obj", "transform": [ { "scale": [1,0,1] } ] })",
            "s.json:4:52: \"scale\" must not be 0: nothing would be left"),
    in_mesh("rotation about no axis", R"({ "obj": "good.obj", "transform": [ { "rotate": [0,0,0,30] } ] })",
            "s.json:4:53: \"rotate\" needs an axis that is not (0,0,0)"),
    in_mesh("rotation without angle", R"({ "obj": "good.obj", "transform": [ { "rotate": [0,0,1] } ] })",
            "s.json:4:53: \"rotate\" must be an array of 4 numbers, but has 3"),
    in_mesh("two keys in one step",
            R"({ "obj": "good.obj", "transform": [ { "scale": 1, "translate": [0,0,0] } ] })",
            "s.json:4:41: a transform step has one key: \"scale\", \"rotate\", \"translate\" or "
            "\"matrix\""),
    in_mesh("transform is an object", R"({ "obj": "good.obj", "transform": { "scale": 1 } })",
            "s.json:4:39: \"transform\" must be an array, not an object"),
    in_mesh("flat matrix",
            R"({ "obj": "good.obj", "transform": [ { "matrix": [1,2,3,0, 2,4,6,0, 0,0,1,0] } ] })",
            "s.json:4:53: the matrix flattens space, or is not finite: it needs an inverse"),
    in_instances("instance without object", R"({ "transforms": "t.txt" })", "",
                 "s.json:3:18: an instance needs the key 'object'"),
    in_instances("unknown object", R"({ "object": "tre" })", "",
                 "s.json:3:30: object 'tre' not found; did you mean 'tree'?"),
    in_instances("no file of transforms", R"({ "object": "tree", "transforms": "u.txt" })", "",
                 "s.json:3:52: no such file: u.txt"),
    in_instances("short transform", R"({ "object": "tree", "transforms": [[1,0,0]] })", "",
                 "s.json:3:53: \"transforms\"[0] must be an array of 12 numbers, but has 3"),
    in_instances("empty file of transforms", R"({ "object": "tree", "transforms": "t.txt" })", "# none\n",
                 "t.txt: no transforms: it needs 12 numbers a line"),
    in_instances("short line of transforms", R"({ "object": "tree", "transforms": "t.txt" })", "# a\n1 0 0\n",
                 "t.txt:2:6: '12 numbers of a transform' needs more numbers"),
    in_instances("long line of transforms", R"({ "object": "tree", "transforms": "t.txt" })",
                 "1 0 0 0 0 1 0 0 0 0 1 0 9\n", "t.txt:1:25: more than the 12 numbers of a transform"),
    in_instances("flat line of transforms", R"({ "object": "tree", "transforms": "t.txt" })",
                 "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 1 1 0 0\n",
                 "t.txt:2: the matrix flattens space, or is not finite: it needs an inverse"),
    in_mesh("crease_angle of flat normals", R"({ "obj": "good.obj", "normals": "face", "crease_angle": 30 })",
            "s.json:4:45: \"crease_angle\" goes with \"normals\": \"smooth\" only"),
    in_mesh("unknown kind of normals", R"({ "obj": "good.obj", "normals": "soft" })",
            "s.json:4:37: unknown \"normals\" 'soft'; known: file, face, smooth"),
    in_mesh("both OBJ and PLY", R"({ "obj": "good.obj", "ply": "good.ply" })",
            "s.json:4:26: give \"obj\" or \"ply\", not both"),
    {"a PLY without faces in a scene",
     {scene_with_mesh(R"({ "ply": "o.ply" })"), {"o.ply", "ply\nformat ascii 1.0\nend_header\n"}},
     "o.ply: no faces, so that the scene has no triangle"},
    {"an OBJ without triangles in a scene",
     {scene_with_mesh(R"({ "obj": "o.obj" })"), {"o.obj", three}},
     "o.obj: no faces, so that the scene has no triangle"},
    // OBJ
    in_obj("index 0", three + "f 1 2 0\n",
           "o.obj:4:7: vertex index 0 is out of range: valid are 1 .. 3 and -3 .. -1"),
    in_obj("index too large", three + "f 1 2 4\n",
           "o.obj:4:7: vertex index 4 is out of range: valid are 1 .. 3 and -3 .. -1"),
    in_obj("index too small", three + "f 1 2 -4\n",
           "o.obj:4:7: vertex index -4 is out of range: valid are 1 .. 3 and -3 .. -1"),
    in_obj("index beyond 2^32, a valid one modulo 2^32", three + "f 1 2 4294967299\n",
           "o.obj:4:7: vertex index 4294967299 is out of range: valid are 1 .. 3 and -3 .. -1"),
    in_obj("index 2^31", three + "f 1 2 2147483648\n",
           "o.obj:4:7: vertex index 2147483648 is out of range: valid are 1 .. 3 and -3 .. -1"),
    in_obj("index -2^31", three + "f 1 2 -2147483648\n",
           "o.obj:4:7: vertex index -2147483648 is out of range: valid are 1 .. 3 and -3 .. -1"),
    in_obj("index beyond 2^64", three + "f 1 2 99999999999999999999/1\n",
           "o.obj:4:7: vertex index 99999999999999999999 is out of range: valid are 1 .. 3 and -3 .. -1"),
    in_obj("face without vertices", "f 1 2 3\n",
           "o.obj:1:3: vertex index 1 is out of range: the file has none"),
    in_obj("counting back in front of all vertices", "f 1 2 -1\n" + three,
           "o.obj:1:7: vertex index -1 is out of range: valid are 1 .. 3"),
    in_obj("too large an index in front of all vertices", "f 1 2 4\n" + three,
           "o.obj:1:7: vertex index 4 is out of range: valid are 1 .. 3"),
    in_obj("normal out of range", three + "vn 0 0 1\nf 1//1 2//1 3//2\n",
           "o.obj:5:13: normal index 2 is out of range: valid are 1 .. 1 and -1 .. -1"),
    in_obj("a corner that is no number", three + "f 1 x 3\n", "o.obj:4:5: 'x' is not a vertex index"),
    in_obj("a corner with four parts", three + "vt 0\nvn 0 0 1\nf 1/1/1/1 2 3\n",
           "o.obj:6:3: '1/1/1/1' is not a corner; write v, v/vt, v//vn or v/vt/vn"),
    in_obj("a vertex of two numbers", "v 1 2\n", "o.obj:1:6: 'v' needs more numbers"),
    in_obj("a vertex that is no number", "# x\n\nv 1 2 x3\n", "o.obj:3:7: 'x3' is not a number, in 'v'"),
    in_obj("a number with something behind", "v 1 2 3,5\n", "o.obj:1:7: '3,5' is not a number, in 'v'"),
    in_obj("a vertex out of double's range", "v 1 2 1e999\n", "o.obj:1:7: '1e999' is out of range, in 'v'"),
    in_obj("nothing in it", "", "o.obj: no faces, so that the scene has no triangle"),
    in_obj("binary",
           std::string("\x7f"
                       "ELF\0\0\1\2\n\xff\xfe",
                       12),
           "o.obj: is binary, not a text; is it another format?"),
    in_obj("packed by gzip", "\x1f\x8b\x08 ...", "o.obj: is packed by gzip; unpack it first"),
    in_obj("packed by zip", "PK\x03\x04 ...", "o.obj: is packed by zip; unpack it first"),
    in_obj("in capitals", "V 0 0 0\nV 1 0 0\nV 0 1 0\nF 1 2 3\n",
           "o.obj:1: a statement in capitals means nothing; write v, vn, vt and f"),
    {"a packed scene file", {{"s.json", "\x1f\x8b\x08 ..."}}, "s.json: is packed by gzip; unpack it first"},
    {"a packed PLY file", {{"t.ply", "\x1f\x8b\x08 ..."}}, "t.ply: is packed by gzip; unpack it first"},
    in_obj("all flat", three + "f 1 1 2\nf 1 2 2\n",
           "o.obj: the scene has no triangle left: all 2 are degenerate (no area, or coordinates that are "
           "not finite)"),
    in_obj("all NaN", "v nan 0 0\nv inf 0 0\nv 0 0 0\nf 1 2 3\n",
           "o.obj: the scene has no triangle left: all 1 are degenerate (no area, or coordinates that are "
           "not finite)"),
    in_obj("a texture coordinate out of range", three + "vt 0 0\nf 1/1 2/1 3/2\n",
           "o.obj:5:11: texture coordinate index 2 is out of range: valid are 1 .. 1 and -1 .. -1"),
    in_obj("UTF-16",
           std::string("\xff\xfe"
                       "v\0 \0",
                       6),
           "o.obj: is UTF-16; save it as UTF-8"),
    in_obj("UTF-16 without a byte order mark",
           std::string("\0v\0 \0"
                       "1",
                       6),
           "o.obj: is UTF-16; save it as UTF-8"),
    // MTL
    in_mtl("a colour that is no number", "newmtl a\nKd 1 x 1\n", "o.mtl:2:6: 'x' is not a number, in 'Kd'"),
    in_mtl("Kd of two numbers", "newmtl a\nKd 1 1\n", "o.mtl:2:7: 'Kd' needs more numbers"),
    in_mtl("Ke that floats do not hold", "newmtl a\nKe 1 1e300 1\n",
           "o.mtl:2:6: Ke must be a number of at most 1e+30, not 1e+300"),
    in_mtl("Ke that is not finite", "newmtl a\nKe nan 1 1\n",
           "o.mtl:2:4: Ke must be a number of at most 1e+30, not nan"),
    // Files
    {"another suffix",
     {{"s.stl", ""}},
     "s.stl: not a scene: its name must end in .json, .gltf, .glb, .obj or .ply"},
};

}  // namespace

TEST_CASE("a fault in a scene gives one line with place and remedy, and exit code 2") {
  for (const Case& faulty : cases) {
    INFO(faulty.what);
    const TemporaryFolder folder;
    for (const File& file : faulty.files) std::ofstream(folder / file.name, std::ios::binary) << file.content;
    const RunResult outcome = run_castray({"info", faulty.files.front().name}, folder.path());
    CHECK(outcome.err == "castray: error: " + faulty.message + "\n");
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out == "");
    CHECK(outcome.peak_kilobytes < 200'000);
  }
}
