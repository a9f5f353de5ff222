// SPDX-License-Identifier: Apache-2.0
// Normals and tangent frames that a file leaves out or gets wrong.
#pragma once

#include "gazetrace/scene.hpp"

namespace gazetrace {

// Flat normals as glTF 2.0 section 3.7.2.1 requires where a primitive has none: every triangle gets vertices of its
// own. A triangle without area gets +z.
void make_flat_normals(Geometry& geometry);

// Normalises; a zero normal becomes the area-weighted mean of the triangles at its vertex.
void repair_normals(Geometry& geometry);

// Tangents for a normal map read through `normal_texture`, in the convention of MikkTSpace as glTF uses it: the tangent
// points along growing u, w is the sign with which cross(normal, tangent) points along *falling* v (up in the picture).
// Each corner's direction is projected onto its vertex's plane, weighted by the corner's angle and averaged over the
// triangles that share the vertex index. A vertex between triangles of opposite handedness is doubled. Differs from
// MikkTSpace in that vertices are not welded first. Where uvs have no area any perpendicular direction serves.
void make_tangents(Geometry& geometry, const TextureRef& normal_texture);

// Unit length, perpendicular to the normal; w becomes 1 or -1.
void repair_tangents(Geometry& geometry);

}  // namespace gazetrace
