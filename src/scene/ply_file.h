#pragma once

#include "scene/obj_file.h"

namespace castray {

/// Reads a PLY file (Turk 1994), ASCII or binary of either byte order, or the bytes that are its content:
/// polygons and triangle strips; normals, texture coordinates and colours of vertices; texture coordinates of
/// faces' corners (MeshLab's "texcoord"). What else it holds is left out. It is in no material's name. Warns
/// of what is odd; throws InputError with file, and line or byte, of what is broken.
ObjFile parse_ply(std::string_view bytes, const std::filesystem::path& file, WarningList& warnings);
ObjFile read_ply(const std::filesystem::path& file, WarningList& warnings);

}  // namespace castray
