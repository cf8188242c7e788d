// Repaired corners → vertices: one primitive per material, each with its own run of vertices.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/io/image.h"
#include "precompute/mesh/atlas.h"
#include "precompute/mesh/corner_mesh.h"
#include "precompute/mesh/index_table.h"
#include "precompute/mesh/interrupt.h"

namespace prt {
namespace {

/// Size at which a second UV set that came with the mesh is checked for overlaps.
constexpr int kAtlasCheckTexels = 1024;

void checkInput(const Scene& scene, const std::string& where) {
    const size_t vertices = scene.vertexCount();
    const auto fits = [&](size_t size) { return size == 0 || size == vertices; };
    if (!fits(scene.normals.size()) || !fits(scene.tangents.size()) || !fits(scene.uv0.size()) ||
        !fits(scene.uv1.size()))
        throw InputError(
            where, fmt::format("an attribute does not have one entry for each of {} vertices", vertices),
            "re-export the mesh");
    if (scene.indices.size() % 3 != 0)
        throw InputError(where, fmt::format("{} indices are not whole triangles", scene.indices.size()),
                         "re-export the mesh");
    for (size_t i = 0; i < scene.indices.size(); ++i)
        if (scene.indices[i] >= vertices)
            throw InputError(where,
                             fmt::format("face {} uses vertex {} of {}", i / 3, scene.indices[i], vertices),
                             "re-export the mesh");
}

/// Whether one primitive's entries of an attribute are only the filling for "absent".
bool allZero(const std::vector<Vec2f>& values, const uint32_t* begin, const uint32_t* end) {
    return std::all_of(begin, end, [&](uint32_t v) { return values[v].isZero(0.0f); });
}

CornerMesh cornersOf(Scene&& scene, const std::string& where) {
    checkInput(scene, where);
    CornerMesh mesh;
    mesh.position = scene.indices;
    if (!scene.normals.empty()) mesh.normal = scene.indices;
    if (!scene.tangents.empty()) mesh.tangent = scene.indices;
    if (!scene.uv0.empty()) mesh.texcoord = scene.indices;
    if (!scene.uv1.empty()) mesh.uv1Index = scene.indices;
    mesh.material.assign(scene.triangleCount(), 0);
    for (const ScenePrimitive& primitive : scene.primitives) {
        if (size_t(primitive.firstIndex) + primitive.indexCount > scene.indices.size() ||
            primitive.firstIndex % 3 != 0 || primitive.indexCount % 3 != 0)
            throw InputError(where, "a primitive lies outside the index array", "re-export the mesh");
        const auto begin = mesh.position.data() + primitive.firstIndex;
        const auto end = begin + primitive.indexCount;
        std::fill(mesh.material.begin() + primitive.firstIndex / 3,
                  mesh.material.begin() + (primitive.firstIndex + primitive.indexCount) / 3,
                  std::max(primitive.material, 0));
        if (!scene.uv0.empty() && allZero(scene.uv0, begin, end))
            std::fill_n(mesh.texcoord.begin() + primitive.firstIndex, primitive.indexCount, kNone);
    }
    mesh.positions = std::move(scene.positions);
    mesh.normals = std::move(scene.normals);
    mesh.tangents = std::move(scene.tangents);
    mesh.uv0 = std::move(scene.uv0);
    mesh.uv1 = std::move(scene.uv1);
    mesh.materials = std::move(scene.materials);
    mesh.textures = std::move(scene.textures);
    return mesh;
}

void checkMaterials(CornerMesh& mesh, const std::string& where) {
    if (mesh.materials.empty()) {
        mesh.materials.emplace_back();
        mesh.materials.back().name = "default";
        std::fill(mesh.material.begin(), mesh.material.end(), 0);
    }
    for (int m : mesh.material)
        if (size_t(m) >= mesh.materials.size())
            throw InputError(where, fmt::format("a face uses material {} of {}", m, mesh.materials.size()),
                             "re-export the mesh");
}

/// Gives materials without a normal map the one of the options.
void addNormalMap(CornerMesh& mesh, const std::string& path) {
    if (path.empty()) return;
    const std::string bytes = readFile(path);
    SceneTexture texture;
    texture.name = path.substr(path.find_last_of('/') + 1);
    texture.encoded.assign(bytes.begin(), bytes.end());
    texture.mimeType = imageMimeType(texture.encoded);
    decodeImage(texture.encoded, path);
    const int index = int(mesh.textures.size());
    bool used = false;
    for (SceneMaterial& material : mesh.materials) {
        if (material.normalTexture >= 0) continue;
        material.normalTexture = index;
        used = true;
    }
    if (used) mesh.textures.push_back(std::move(texture));
}

/// Forgets tangents that are unusable, or belong to a normal or texture coordinates that were made here.
void checkTangents(CornerMesh& mesh, size_t givenNormals, size_t givenTexcoords) {
    for (size_t h = 0; h < mesh.tangent.size(); ++h) {
        if (mesh.tangent[h] == kNone) continue;
        const Vec4f& given = mesh.tangents[mesh.tangent[h]];
        const Vec3f direction = given.head<3>();
        const bool usable = given.allFinite() && std::abs(direction.norm() - 1) < 0.1f &&
                            std::abs(std::abs(given.w()) - 1) < 1e-3f && mesh.normal[h] < givenNormals &&
                            mesh.texcoord[h] < givenTexcoords &&
                            std::abs(direction.dot(mesh.normals[mesh.normal[h]])) < 0.1f;
        if (!usable) mesh.tangent[h] = kNone;
    }
}

/// Builds vertices out of corners whose attributes are equal.
class Assembler {
  public:
    Assembler(const CornerMesh& mesh, const std::vector<Vec3f>& faceNormal, size_t givenNormals,
              size_t givenTexcoords)
        : mesh_(mesh),
          faceNormal_(faceNormal),
          givenNormals_(givenNormals),
          givenTexcoords_(givenTexcoords) {}

    Scene assemble(LoadMeshReport& report);

  private:
    struct Corner {
        uint32_t position;
        Vec3f normal;
        Vec2f uv0, uv1;
        Vec4f tangent;  ///< zero when it is to be made
        int side;       ///< handedness, 0 with a given tangent
    };

    Corner corner(uint32_t h) const;
    uint32_t addCorner(IndexTable& table, uint32_t firstVertex, uint32_t h);

    const CornerMesh& mesh_;
    const std::vector<Vec3f>& faceNormal_;
    const size_t givenNormals_, givenTexcoords_;
    Scene scene_;
    std::vector<uint32_t> positionOfVertex_;
    std::vector<int8_t> side_;
    size_t madeNormals_ = 0, madeTexcoords_ = 0;
};

Assembler::Corner Assembler::corner(uint32_t h) const {
    Corner c{mesh_.position[h],
             mesh_.normals[mesh_.normal[h]],
             mesh_.uv0[mesh_.texcoord[h]],
             {0, 0},
             {0, 0, 0, 0},
             0};
    if (!mesh_.uv1Index.empty()) c.uv1 = mesh_.uv1[mesh_.uv1Index[h]];
    if (!mesh_.tangent.empty() && mesh_.tangent[h] != kNone) {
        c.tangent = mesh_.tangents[mesh_.tangent[h]];
        c.tangent.w() = c.tangent.w() < 0 ? -1.0f : 1.0f;
        const Vec3f direction = c.tangent.head<3>();
        if (std::abs(direction.dot(c.normal)) > 1e-3f || std::abs(direction.norm() - 1) > 1e-3f)
            c.tangent.head<3>() = (direction - c.normal * c.normal.dot(direction)).normalized();
        return c;
    }
    const uint32_t first = h - h % 3;
    const int side =
        cornerHandedness(c.normal, faceNormal_[h / 3], mesh_.uv0[mesh_.texcoord[first]],
                         mesh_.uv0[mesh_.texcoord[first + 1]], mesh_.uv0[mesh_.texcoord[first + 2]]);
    c.side = side < 0 ? -1 : 1;
    return c;
}

uint32_t Assembler::addCorner(IndexTable& table, uint32_t firstVertex, uint32_t h) {
    const Corner c = corner(h);
    uint64_t hash = mixHash(c.position, uint64_t(uint32_t(c.side)));
    for (int i = 0; i < 3; ++i) hash = mixHash(hash, floatKey(c.normal[i]));
    for (int i = 0; i < 2; ++i)
        hash = mixHash(hash, floatKey(c.uv0[i]) + (uint64_t(floatKey(c.uv1[i])) << 32));
    const auto next = uint32_t(scene_.positions.size());
    const uint32_t vertex = table.findOrInsert(hash, next, [&](uint32_t other) {
        return positionOfVertex_[other] == c.position && side_[other] == c.side &&
               scene_.normals[other] == c.normal && scene_.uv0[other] == c.uv0 &&
               (scene_.uv1.empty() || scene_.uv1[other] == c.uv1) && scene_.tangents[other] == c.tangent &&
               other >= firstVertex;
    });
    if (vertex != next) return vertex;
    scene_.positions.push_back(mesh_.positions[c.position]);
    scene_.normals.push_back(c.normal);
    scene_.tangents.push_back(c.tangent);
    scene_.uv0.push_back(c.uv0);
    if (!mesh_.uv1Index.empty()) scene_.uv1.push_back(c.uv1);
    positionOfVertex_.push_back(c.position);
    side_.push_back(int8_t(c.side));
    madeNormals_ += mesh_.normal[h] >= givenNormals_;
    madeTexcoords_ += mesh_.texcoord[h] >= givenTexcoords_;
    return vertex;
}

Scene Assembler::assemble(LoadMeshReport& report) {
    scene_.materials = mesh_.materials;
    scene_.textures = mesh_.textures;
    scene_.indices.reserve(mesh_.position.size());
    std::vector<uint32_t> order(mesh_.triangleCount());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return mesh_.material[a] < mesh_.material[b]; });
    for (size_t i = 0; i < order.size();) {
        size_t end = i;
        while (end < order.size() && mesh_.material[order[end]] == mesh_.material[order[i]]) ++end;
        ScenePrimitive primitive;
        primitive.material = mesh_.material[order[i]];
        primitive.firstVertex = uint32_t(scene_.positions.size());
        primitive.firstIndex = uint32_t(scene_.indices.size());
        IndexTable table(end - i);
        for (; i < end; ++i) {
            throwIfInterruptedAt(scene_.indices.size() / 3);
            for (uint32_t k = 0; k < 3; ++k)
                scene_.indices.push_back(addCorner(table, primitive.firstVertex, 3 * order[i] + k));
        }
        primitive.vertexCount = uint32_t(scene_.positions.size()) - primitive.firstVertex;
        primitive.indexCount = uint32_t(scene_.indices.size()) - primitive.firstIndex;
        scene_.primitives.push_back(primitive);
    }
    std::vector<uint8_t> keep(scene_.vertexCount());
    for (size_t v = 0; v < keep.size(); ++v) keep[v] = scene_.tangents[v].w() != 0;
    makeTangents(scene_, keep);
    countRepair(report, "normals_made", madeNormals_);
    countRepair(report, "texcoords_made", madeTexcoords_);
    countRepair(report, "tangents_made", size_t(std::count(keep.begin(), keep.end(), uint8_t(0))));
    return std::move(scene_);
}

/// Whether every corner has finite coordinates of the second set inside the unit square.
bool mayBeAtlas(const CornerMesh& mesh) {
    if (mesh.uv1Index.empty()) return false;
    return std::all_of(mesh.uv1Index.begin(), mesh.uv1Index.end(), [&](uint32_t i) {
        const Vec2f& uv = mesh.uv1[i];
        return uv.x() >= 0 && uv.x() <= 1 && uv.y() >= 0 && uv.y() <= 1;
    });
}

}  // namespace

Scene prepareCorners(CornerMesh mesh, const std::string& where, const LoadMeshOptions& options,
                     LoadMeshReport& report) {
    if (!(options.uvScale > 0) || !std::isfinite(options.uvScale))
        throw UsageError("--uv-scale", fmt::format("{} is not a positive length", options.uvScale));
    checkMaterials(mesh, where);
    addNormalMap(mesh, options.normalMap);
    repairFaces(mesh, where, report);
    throwIfInterrupted();
    const size_t givenNormals = mesh.normals.size(), givenTexcoords = mesh.uv0.size();
    const std::vector<Vec3f> faceNormal = faceNormals(mesh.positions, mesh.position);
    {
        const Adjacency adjacency = pairHalfEdges(mesh.position, uint32_t(mesh.positions.size()), faceNormal);
        countRepair(report, "non_manifold_edges_split", adjacency.nonManifoldEdges);
        countRepair(report, "inconsistent_winding_edges", adjacency.inconsistentEdges);
        makeNormals(mesh, adjacency, faceNormal, options.creaseAngleDeg, report);
    }
    throwIfInterrupted();
    makeTexcoords(mesh, faceNormal, options.uvScale);
    checkTangents(mesh, givenNormals, givenTexcoords);
    throwIfInterrupted();

    const bool hadUv1 = !mesh.uv1Index.empty();
    if (mayBeAtlas(mesh)) {
        LoadMeshReport withAtlas = report;
        Scene scene = Assembler(mesh, faceNormal, givenNormals, givenTexcoords).assemble(withAtlas);
        if (isValidAtlas(scene, kAtlasCheckTexels)) {
            report = withAtlas;
            report.hasAtlas = true;
            validateScene(scene, where);
            return scene;
        }
    }
    mesh.uv1Index.clear();
    Scene scene = Assembler(mesh, faceNormal, givenNormals, givenTexcoords).assemble(report);
    countRepair(report, "invalid_atlas_dropped", hadUv1 ? 1 : 0);
    throwIfInterrupted();
    validateScene(scene, where);
    return scene;
}

Scene prepareScene(Scene scene, const std::string& where, const LoadMeshOptions& options,
                   LoadMeshReport* report) {
    LoadMeshReport local;
    return prepareCorners(cornersOf(std::move(scene), where), where, options, report ? *report : local);
}

}  // namespace prt
