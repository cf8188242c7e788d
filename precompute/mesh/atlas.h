// UV atlas: TEXCOORD_1, every part of the surface in its own place.
#pragma once

#include "precompute/io/scene.h"

namespace prt {

struct AtlasOptions {
    int texels = 512;            ///< edge of the square atlas, 16..8192
    int gutter = 2;              ///< texels between charts, at least
    double creaseAngleDeg = 40;  ///< charts end at sharper edges, where the atlas has room for that
    double coneAngleDeg = 60;    ///< largest angle between a face and the mean normal of its chart, < 90
};

struct AtlasReport {
    int charts = 0;
    int splitCharts = 0;       ///< charts split because they overlapped themselves
    double utilisation = 0;    ///< share of texels that charts cover
    double texelsPerUnit = 0;  ///< texels along one scene unit
    double smallestStretch = 1,
           largestStretch = 1;  ///< singular values of the chart maps relative to texelsPerUnit
};

/// Makes uv1: charts grown over edge adjacency within a normal cone, slivers merged into a neighbour where
/// the cone allows, projected onto the plane of the mean normal, split where they overlap themselves, packed
/// at one density. Splits vertices at chart borders; triangle order is kept.
/// @throws InputError  more charts than the atlas has room for (says which --texels would do)
AtlasReport buildAtlas(Scene& scene, const AtlasOptions& options);

/// Whether uv1 is a valid atlas at this size: finite, in [0, 1], no two triangles over one texel centre
/// (triangles that share an edge may touch).
bool isValidAtlas(const Scene& scene, int texels);

}  // namespace prt
