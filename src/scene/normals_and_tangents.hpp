// SPDX-License-Identifier: Apache-2.0
// Makes or repairs the normals and tangents that a file leaves out or gets wrong.
#pragma once

#include "gazetrace/scene.hpp"

namespace gazetrace {

// Makes flat normals, as glTF 2.0 section 3.7.2.1 requires where a primitive has no normals: every triangle gets
// vertices of its own. A triangle without area gets +z.
void make_flat_normals(Geometry& geometry);

// Normalises all normals. A zero normal is replaced by the area-weighted mean of the triangles at its vertex.
void repair_normals(Geometry& geometry);

// Tangents for a normal map read through `normal_texture`, in the convention of MikkTSpace as glTF uses it: the tangent
// points along growing u, w is the sign with which cross(normal, tangent) points along *falling* v (up in the picture).
// Each corner's direction is projected onto its vertex's plane, weighted by the corner's angle and averaged over the
// triangles that share the vertex index. A vertex between triangles of opposite handedness is duplicated. Unlike
// MikkTSpace, vertices are not welded first. Where the uvs have no area, any perpendicular direction is taken.
void make_tangents(Geometry& geometry, const TextureRef& normal_texture);

// Makes tangents perpendicular to their normals and of unit length, and w 1 or -1.
void repair_tangents(Geometry& geometry);

}  // namespace gazetrace
