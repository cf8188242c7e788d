// Filling of gutters and of points inside geometry.
#include "precompute/visibility/fill.h"

#include <algorithm>
#include <cmath>

#include "precompute/math/sh.h"
#include "tests/rays/shapes.h"

namespace prt {
namespace {

constexpr int kOrder = 2;

// A texel of a small drawing: ' ' nothing, 'a'/'b' a point of chart 0/1, 'A'/'B' the same inside geometry.
struct Drawing {
    TexelSurface surface;
    BakeResult baked;

    explicit Drawing(const std::vector<std::string>& rows) {
        surface.width = int(rows[0].size());
        surface.height = int(rows.size());
        for (const std::string& row : rows)
            for (const char c : row) {
                if (c == ' ') {
                    surface.pointOfTexel.push_back(kNoPoint);
                    surface.chartOfTexel.push_back(kNoPoint);
                    continue;
                }
                const float id = float(surface.points.size());
                surface.pointOfTexel.push_back(uint32_t(surface.points.size()));
                surface.chartOfTexel.push_back(std::tolower(c) == 'a' ? 0 : 1);
                surface.points.push_back({{id, 0, 0}, Vec3f(1, id, 0).normalized(), 0});
                for (int i = 0; i < 4; ++i) baked.coefficients.push_back(10 * id + float(i));
                baked.ao.push_back(id / 100);
                baked.error.push_back(id / 1000);
                baked.inside.push_back(std::isupper(c) ? 1 : 0);
            }
    }
};

TEST(FillTexels, KeepsWhatWasBaked) {
    const Drawing drawing({"aab", "abb"});
    const VisibilityMap map = fillTexels(drawing.surface, drawing.baked, kOrder);
    EXPECT_EQ(map.grid.domain, PointDomain::Texel);
    EXPECT_EQ(map.grid.width, 3);
    EXPECT_EQ(map.grid.height, 2);
    EXPECT_EQ(map.grid.count, 6u);
    EXPECT_EQ(map.shOrder, kOrder);
    EXPECT_EQ(map.coefficients, drawing.baked.coefficients);
    EXPECT_EQ(map.ao, drawing.baked.ao);
    EXPECT_EQ(map.error, drawing.baked.error);
    for (const Validity validity : map.validity) EXPECT_EQ(validity, Validity::Valid);
    for (size_t t = 0; t < 6; ++t) EXPECT_EQ(map.normals[t], drawing.surface.points[t].normal);
}

TEST(FillTexels, InsideTakesTheNearestOfItsChart) {
    //              points: 0 1 2 3 4 5
    const Drawing drawing(std::vector<std::string>{"aAAbBb"});
    const VisibilityMap map = fillTexels(drawing.surface, drawing.baked, kOrder);
    const uint32_t source[] = {0, 0, 0, 3, 3, 5};
    for (size_t t = 0; t < 6; ++t) {
        const bool inside = drawing.baked.inside[t] != 0;
        EXPECT_EQ(map.validity[t], inside ? Validity::InsideFilled : Validity::Valid) << t;
        EXPECT_EQ(map.normals[t], drawing.surface.points[t].normal) << t;
        if (t == 4) continue;  // as near to 3 as to 5
        EXPECT_EQ(map.coefficients[4 * t + 1], 10 * float(source[t]) + 1) << t;
        EXPECT_EQ(map.ao[t], float(source[t]) / 100) << t;
        EXPECT_EQ(map.error[t], float(source[t]) / 1000) << t;
    }
    EXPECT_THAT(map.coefficients[17], testing::AnyOf(31.0f, 51.0f));
}

TEST(FillTexels, InsideOutOfReachKeepsItsValue) {
    const Drawing wholly(std::vector<std::string>{"AA  "});
    const VisibilityMap map = fillTexels(wholly.surface, wholly.baked, kOrder);
    EXPECT_EQ(map.validity[0], Validity::Inside);
    EXPECT_EQ(map.validity[1], Validity::Inside);
    EXPECT_EQ(map.validity[2], Validity::Empty);  // no good value to copy
    EXPECT_EQ(map.coefficients[5], 11.0f);

    std::string row(size_t(kInsideReachTexels) + 6, 'A');
    row[0] = 'a';
    const Drawing far(std::vector<std::string>{row});
    const VisibilityMap map2 = fillTexels(far.surface, far.baked, kOrder);
    EXPECT_EQ(map2.validity[kInsideReachTexels], Validity::InsideFilled);
    EXPECT_EQ(map2.validity[kInsideReachTexels + 1], Validity::Inside);
}

TEST(FillTexels, GuttersTakeTheNearestGoodTexel) {
    const std::string gap(kGutterReachTexels + 3, ' ');
    std::string row = gap;
    row.insert(row.begin(), 'a');
    const Drawing drawing(std::vector<std::string>{row});
    const VisibilityMap map = fillTexels(drawing.surface, drawing.baked, kOrder);
    for (size_t x = 1; x <= gap.size(); ++x) {
        const bool reached = x <= size_t(kGutterReachTexels);
        EXPECT_EQ(map.validity[x], reached ? Validity::GutterFilled : Validity::Empty) << x;
        EXPECT_EQ(map.coefficients[x * 4 + 3], reached ? 3.0f : 0.0f);
        EXPECT_EQ(map.normals[x], reached ? drawing.surface.points[0].normal : Vec3f(0, 0, 0));
    }
    // Points inside are filled first (from their chart), and are sources then; those that stay inside are
    // not.
    const Drawing inside({"baA  ", "     ", "B    "});
    const VisibilityMap filled = fillTexels(inside.surface, inside.baked, kOrder);
    EXPECT_EQ(filled.validity[2], Validity::InsideFilled);
    EXPECT_EQ(filled.validity[3], Validity::GutterFilled);
    EXPECT_EQ(filled.coefficients[3 * 4], 10.0f);
    EXPECT_EQ(filled.normals[3], inside.surface.points[2].normal);
    const Drawing dark({"b    ", "     ", "A    "});
    const VisibilityMap beside = fillTexels(dark.surface, dark.baked, kOrder);
    EXPECT_EQ(beside.validity[10], Validity::Inside);
    EXPECT_EQ(beside.validity[11], Validity::GutterFilled);
    EXPECT_EQ(beside.coefficients[11 * 4], 0.0f);  // the texel at the top left, not the one beside
    EXPECT_EQ(beside.coefficients[11 * 4 + 1], 1.0f);
}

TEST(FillVertices, InsideTakesTheMeanOfItsNeighbours) {
    // A strip of squares along x; vertices 2i and 2i + 1 at x = i.
    shapes::Mesh mesh;
    for (int i = 0; i <= 5; ++i)
        for (const float z : {0.0f, 1.0f}) mesh.positions.push_back({float(i), 0, z});
    for (uint32_t i = 0; i < 5; ++i)
        for (const uint32_t v : {0u, 1u, 3u, 0u, 3u, 2u}) mesh.indices.push_back(2 * i + v);
    Scene scene;
    scene.positions = mesh.positions;
    scene.indices = mesh.indices;
    // Another vertex at the place of vertex 4.
    scene.positions.push_back(scene.positions[4]);
    const VertexPoints vertices = makeVertexPoints(scene);
    ASSERT_EQ(vertices.sameAs[12], 4u);
    BakeResult baked;
    for (size_t v = 0; v < 13; ++v) {
        for (int c = 0; c < 4; ++c) baked.coefficients.push_back(v < 4 ? 1.0f + float(c) : 5.0f);
        baked.ao.push_back(v < 4 ? 0.25f : 0.75f);
        baked.error.push_back(v < 4 ? 0.01f : 0.03f);
        baked.inside.push_back((v >= 4 && v < 8) || v == 12);
    }
    const VisibilityMap map = fillVertices(scene, vertices, baked, kOrder);
    EXPECT_EQ(map.grid.domain, PointDomain::Vertex);
    EXPECT_EQ(map.grid.count, 13u);
    for (const size_t v : {4u, 5u, 6u, 7u, 12u}) EXPECT_EQ(map.validity[v], Validity::InsideFilled) << v;
    for (const size_t v : {0u, 1u, 2u, 3u, 8u, 9u}) EXPECT_EQ(map.validity[v], Validity::Valid) << v;
    // Vertices 4 and 5 border only vertices 2 and 3 that are good; 6 and 7 only 8 and 9.
    for (const size_t v : {4u, 5u, 12u}) {
        EXPECT_FLOAT_EQ(map.coefficients[v * 4 + 2], 3.0f);
        EXPECT_FLOAT_EQ(map.ao[v], 0.25f);
        EXPECT_FLOAT_EQ(map.error[v], 0.01f);
    }
    for (const size_t v : {6u, 7u}) EXPECT_FLOAT_EQ(map.coefficients[v * 4 + 2], 5.0f);
    EXPECT_EQ(map.normals, vertices.normals);

    // Nothing good anywhere: values stay, and say so.
    std::fill(baked.inside.begin(), baked.inside.end(), uint8_t(1));
    const VisibilityMap none = fillVertices(scene, vertices, baked, kOrder);
    for (const Validity validity : none.validity) EXPECT_EQ(validity, Validity::Inside);
    EXPECT_EQ(none.coefficients, baked.coefficients);
}

TEST(FillVertices, NearerNeighboursWeighMore) {
    Scene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 3}};
    scene.indices = {0, 2, 1};
    const VertexPoints vertices = makeVertexPoints(scene);
    BakeResult baked;
    baked.coefficients = {9, 1, 2};
    baked.ao = {0.9f, 0.1f, 0.2f};
    baked.error = {0.01f, 0.02f, 0.03f};
    baked.inside = {1, 0, 0};
    const VisibilityMap map = fillVertices(scene, vertices, baked, 1);
    // Each edge of one triangle is met once: weights 1 and 1/3.
    EXPECT_FLOAT_EQ(map.coefficients[0], (1.0f + 2.0f / 3) / (4.0f / 3));
    EXPECT_FLOAT_EQ(map.ao[0], (0.1f + 0.2f / 3) / (4.0f / 3));
    EXPECT_FLOAT_EQ(map.error[0], (0.02f + 0.03f / 3) / (4.0f / 3));
}

}  // namespace
}  // namespace prt
