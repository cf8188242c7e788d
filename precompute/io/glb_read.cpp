// glTF 2.0 in: nodes, materials and primitives.
// Sources: glTF 2.0 specification (nodes 3.5.3, topology and tangents 3.7.2.1, materials 3.9);
// EXT_texture_webp; KHR_mesh_quantization. tinygltf trusts every index: all are checked here and in
// gltf_accessor.cpp.
#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <memory>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/glb.h"
#include "precompute/io/gltf_accessor.h"
#include "precompute/io/gltf_load.h"
#include "precompute/io/image.h"

namespace prt {
namespace fs = std::filesystem;
namespace {

// ---- transforms
//

using Mat4d = Eigen::Matrix<double, 4, 4, Eigen::DontAlign>;

Mat4d localTransform(const tinygltf::Node& node) {
    Mat4d local = Mat4d::Identity();
    if (node.matrix.size() == 16) {
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row) local(row, column) = node.matrix[size_t(column * 4 + row)];
        return local;
    }
    if (node.rotation.size() == 4) {
        const Eigen::Quaternion<double, Eigen::DontAlign> rotation(node.rotation[3], node.rotation[0],
                                                                   node.rotation[1], node.rotation[2]);
        local.topLeftCorner<3, 3>() = rotation.normalized().toRotationMatrix();
    }
    for (int axis = 0; axis < 3; ++axis) {
        if (node.scale.size() == 3) local.block<3, 1>(0, axis) *= node.scale[size_t(axis)];
        if (node.translation.size() == 3) local(axis, 3) = node.translation[size_t(axis)];
    }
    return local;
}

struct MeshInstance {
    int mesh;
    Mat4d worldFromMesh;
};

/// Nodes to start from: those of the default scene, else of the first, else all that are no node's child.
std::vector<int> rootNodes(const tinygltf::Model& model, const std::string& path) {
    if (!model.scenes.empty()) {
        const size_t scene = size_t(std::max(model.defaultScene, 0));
        if (scene >= model.scenes.size())
            throw InputError(path, fmt::format("uses scene {} of {}", scene, model.scenes.size()));
        return model.scenes[scene].nodes;
    }
    std::vector<bool> isChild(model.nodes.size());
    for (const tinygltf::Node& node : model.nodes)
        for (int child : node.children)
            if (child >= 0 && size_t(child) < isChild.size()) isChild[size_t(child)] = true;
    std::vector<int> roots;
    for (size_t i = 0; i < isChild.size(); ++i)
        if (!isChild[i]) roots.push_back(int(i));
    return roots;
}

std::vector<MeshInstance> findInstances(const tinygltf::Model& model, const std::string& path) {
    std::vector<MeshInstance> instances;
    if (model.nodes.empty() && model.scenes.empty())
        for (size_t mesh = 0; mesh < model.meshes.size(); ++mesh)
            instances.push_back({int(mesh), Mat4d::Identity()});
    struct Open {
        int node;
        Mat4d worldFromParent;
    };
    std::vector<Open> open;
    std::vector<int> roots = rootNodes(model, path);
    for (size_t i = roots.size(); i-- > 0;) open.push_back({roots[i], Mat4d::Identity()});
    std::vector<bool> visited(model.nodes.size());
    while (!open.empty()) {
        const Open next = open.back();
        open.pop_back();
        if (next.node < 0 || size_t(next.node) >= model.nodes.size())
            throw InputError(path, fmt::format("uses node {} of {}", next.node, model.nodes.size()));
        const tinygltf::Node& node = model.nodes[size_t(next.node)];
        if (visited[size_t(next.node)])
            throw InputError(path, fmt::format("node {} is reached twice; the nodes are no tree", next.node),
                             "export it again");
        visited[size_t(next.node)] = true;
        const Mat4d world = next.worldFromParent * localTransform(node);
        if (node.mesh >= 0) {
            if (size_t(node.mesh) >= model.meshes.size())
                throw InputError(path, fmt::format("node {} uses mesh {} of {}", next.node, node.mesh,
                                                   model.meshes.size()));
            if (!world.allFinite())
                throw InputError(path, fmt::format("node {} has a transform that is not finite", next.node));
            instances.push_back({node.mesh, world});
        }
        for (size_t i = node.children.size(); i-- > 0;) open.push_back({node.children[i], world});
    }
    return instances;
}

// ---- materials
//

struct Materials {
    std::vector<SceneMaterial> materials;
    std::vector<SceneTexture> textures;
    std::vector<int> uvSet;  ///< TEXCOORD_n of each material
};

int imageOfTexture(const tinygltf::Model& model, int texture, const std::string& where) {
    if (texture < 0) return -1;
    if (size_t(texture) >= model.textures.size())
        throw InputError(where, fmt::format("uses texture {} of {}", texture, model.textures.size()));
    const tinygltf::Texture& found = model.textures[size_t(texture)];
    int image = found.source;
    if (const auto webp = found.extensions.find("EXT_texture_webp");
        webp != found.extensions.end() && webp->second.Has("source"))
        image = webp->second.Get("source").GetNumberAsInt();
    if (image < 0 || size_t(image) >= model.images.size())
        throw InputError(where, fmt::format("uses image {} of {}", image, model.images.size()));
    return image;
}

bool isTrivialTransform(const tinygltf::Value& transform) {
    const auto isPair = [&](const char* key, double expected) {
        if (!transform.Has(key)) return true;
        const tinygltf::Value& pair = transform.Get(key);
        return pair.IsArray() && pair.ArrayLen() == 2 && pair.Get(0).GetNumberAsDouble() == expected &&
               pair.Get(1).GetNumberAsDouble() == expected;
    };
    const bool turned = transform.Has("rotation") && transform.Get("rotation").GetNumberAsDouble() != 0;
    return isPair("offset", 0) && isPair("scale", 1) && !turned;
}

template <class TextureInfo>
void warnOfTransform(const TextureInfo& info, const std::string& where) {
    const auto found = info.extensions.find("KHR_texture_transform");
    if (info.index >= 0 && found != info.extensions.end() && !isTrivialTransform(found->second))
        logWarning(where + ": KHR_texture_transform is ignored; apply it to the texture coordinates");
}

SceneTexture loadTexture(const tinygltf::Model& model, int index, const std::string& path) {
    const tinygltf::Image& image = model.images[size_t(index)];
    const std::string where = fmt::format("{}: image {}", path, index);
    SceneTexture texture;
    texture.name = !image.name.empty() ? image.name : fs::path(image.uri).filename().string();
    if (image.bufferView >= 0) {
        const std::span<const uint8_t> bytes = gltfViewBytes(model, image.bufferView, where);
        texture.encoded.assign(bytes.begin(), bytes.end());
    } else {
        texture.encoded = image.image;
    }
    if (texture.encoded.empty())
        throw InputError(where,
                         image.uri.empty() ? std::string("has no bytes")
                                           : fmt::format("there is no file \"{}\" beside it", image.uri),
                         "put the image beside the mesh, or export as GLB");
    texture.mimeType = imageMimeType(texture.encoded);
    if (texture.mimeType.empty())
        throw InputError(where, "is not a PNG, JPEG or WebP image", "convert it to one of these");
    return texture;
}

Materials loadMaterials(const tinygltf::Model& model, const std::string& path) {
    Materials out;
    for (size_t i = 0; i < model.materials.size(); ++i) {
        const tinygltf::Material& from = model.materials[i];
        const std::string where = fmt::format("{}: material {}", path, i);
        const tinygltf::TextureInfo& colour = from.pbrMetallicRoughness.baseColorTexture;
        SceneMaterial material;
        material.name = from.name;
        const std::vector<double>& factor = from.pbrMetallicRoughness.baseColorFactor;
        material.baseColor = Vec3f::Ones();
        for (size_t c = 0; c < 3 && factor.size() >= 3; ++c)
            material.baseColor[Eigen::Index(c)] = float(factor[c]);
        material.baseColorTexture = imageOfTexture(model, colour.index, where);
        material.normalTexture = imageOfTexture(model, from.normalTexture.index, where);
        material.normalScale = float(from.normalTexture.scale);
        material.doubleSided = from.doubleSided;
        warnOfTransform(colour, where);
        warnOfTransform(from.normalTexture, where);
        const int uvSet = colour.index >= 0               ? colour.texCoord
                          : from.normalTexture.index >= 0 ? from.normalTexture.texCoord
                                                          : 0;
        if (from.normalTexture.index >= 0 && from.normalTexture.texCoord != uvSet)
            logWarning(where +
                       ": its two textures use different texture coordinates; those of the colour are used");
        out.uvSet.push_back(uvSet);
        out.materials.push_back(std::move(material));
    }
    // Only images that are used, in the order of the file.
    std::vector<int> textureOfImage(model.images.size(), -1);
    for (const SceneMaterial& material : out.materials)
        for (int image : {material.baseColorTexture, material.normalTexture})
            if (image >= 0) textureOfImage[size_t(image)] = 0;
    for (size_t image = 0; image < textureOfImage.size(); ++image) {
        if (textureOfImage[image] < 0) continue;
        textureOfImage[image] = int(out.textures.size());
        out.textures.push_back(loadTexture(model, int(image), path));
    }
    for (SceneMaterial& material : out.materials)
        for (int* image : {&material.baseColorTexture, &material.normalTexture})
            if (*image >= 0) *image = textureOfImage[size_t(*image)];
    return out;
}

// ---- primitives
//

/// Triangles out of any of the three triangle modes.
std::vector<uint32_t> triangulate(std::vector<uint32_t> indices, int mode, const std::string& where) {
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        if (indices.size() % 3 != 0)
            throw InputError(where, fmt::format("has {} indices, not a multiple of 3", indices.size()));
        return indices;
    }
    std::vector<uint32_t> triangles;
    for (size_t i = 0; i + 2 < indices.size(); ++i) {
        const bool strip = mode == TINYGLTF_MODE_TRIANGLE_STRIP;
        const std::array<size_t, 3> corners = strip ? std::array<size_t, 3>{i, i + 1 + i % 2, i + 2 - i % 2}
                                                    : std::array<size_t, 3>{i + 1, i + 2, 0};
        for (size_t corner : corners) triangles.push_back(indices[corner]);
    }
    return triangles;
}

template <class Vector>
std::vector<Vector> asVectors(const std::vector<float>& values) {
    constexpr size_t kWidth = size_t(Vector::RowsAtCompileTime);
    std::vector<Vector> vectors(values.size() / kWidth);
    for (size_t i = 0; i < vectors.size(); ++i)
        for (size_t c = 0; c < kWidth; ++c) vectors[i][Eigen::Index(c)] = values[i * kWidth + c];
    return vectors;
}

/// Unit, unless it has no length; values that are unit up to rounding stay what they are.
Vec3f normalizedOrZero(const Vec3d& vector) {
    const double length = vector.norm();
    if (!(length > 0)) return Vec3f::Zero();
    return (std::abs(length - 1) < 1e-5 ? vector : Vec3d(vector / length)).template cast<float>();
}

class SceneBuilder {
  public:
    SceneBuilder(const tinygltf::Model& model, const std::string& path)
        : model_(model), path_(path), materials_(loadMaterials(model, path)) {}

    Scene build() {
        const std::vector<MeshInstance> instances = findInstances(model_, path_);
        for (const MeshInstance& instance : instances) {
            const auto& primitives = model_.meshes[size_t(instance.mesh)].primitives;
            for (size_t p = 0; p < primitives.size(); ++p)
                addPrimitive(primitives[p], instance.worldFromMesh,
                             fmt::format("{}: mesh {}, primitive {}", path_, instance.mesh, p));
        }
        if (scene_.indices.empty())
            throw InputError(path_, "has no triangles", skipped_ ? "it has points or lines only" : "");
        if (skipped_ > 0)
            logWarning(fmt::format("{}: {} primitives of points or lines left out", path_, skipped_));
        if (morphed_) logWarning(path_ + ": morph targets are ignored");
        scene_.materials = std::move(materials_.materials);
        scene_.textures = std::move(materials_.textures);
        return std::move(scene_);
    }

  private:
    /// Values of one attribute, or none.
    template <class Vector>
    std::vector<Vector> attribute(const tinygltf::Primitive& primitive, const std::string& name, size_t count,
                                  const std::string& where) const {
        const auto found = primitive.attributes.find(name);
        if (found == primitive.attributes.end()) return {};
        const std::string place = where + ", " + name;
        std::vector<Vector> values =
            asVectors<Vector>(readGltfFloats(model_, found->second, int(Vector::RowsAtCompileTime), place));
        if (values.size() != count)
            throw InputError(place, fmt::format("has {} values for {} vertices", values.size(), count));
        return values;
    }

    /// Adds the values behind those of earlier primitives; zeros stand for what some primitives lack.
    template <class Vector>
    void append(std::vector<Vector>& all, const std::vector<Vector>& values, size_t first,
                size_t count) const {
        if (values.empty() && all.empty()) return;
        all.resize(first, Vector::Zero());
        all.insert(all.end(), values.begin(), values.end());
        all.resize(first + count, Vector::Zero());
    }

    std::vector<uint32_t> readTriangles(const tinygltf::Primitive& primitive, size_t count,
                                        const std::string& where) const {
        std::vector<uint32_t> indices;
        if (primitive.indices >= 0) {
            indices = readGltfIndices(model_, primitive.indices, where + ", indices");
        } else {
            indices.resize(count);
            for (size_t i = 0; i < count; ++i) indices[i] = uint32_t(i);
        }
        for (size_t i = 0; i < indices.size(); ++i)
            if (indices[i] >= count)
                throw InputError(where, fmt::format("index {} uses vertex {} of {}", i, indices[i], count),
                                 "export the mesh again");
        return triangulate(std::move(indices), primitive.mode, where);
    }

    int materialOf(const tinygltf::Primitive& primitive, const std::string& where) {
        if (primitive.material >= 0) {
            if (size_t(primitive.material) >= model_.materials.size())
                throw InputError(where, fmt::format("uses material {} of {}", primitive.material,
                                                    model_.materials.size()));
            return primitive.material;
        }
        // glTF's default material is white.
        if (defaultMaterial_ < 0) {
            defaultMaterial_ = int(materials_.materials.size());
            SceneMaterial material;
            material.name = "default";
            material.baseColor = Vec3f::Ones();
            materials_.materials.push_back(material);
            materials_.uvSet.push_back(0);
        }
        return defaultMaterial_;
    }

    void addPrimitive(const tinygltf::Primitive& primitive, const Mat4d& world, const std::string& where) {
        if (primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != TINYGLTF_MODE_TRIANGLE_STRIP &&
            primitive.mode != TINYGLTF_MODE_TRIANGLE_FAN) {
            ++skipped_;
            return;
        }
        morphed_ = morphed_ || !primitive.targets.empty();
        const auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end()) throw InputError(where, "has no POSITION");
        const size_t count = gltfAccessorCount(model_, position->second, where);
        std::vector<Vec3f> positions = attribute<Vec3f>(primitive, "POSITION", count, where);
        std::vector<uint32_t> indices = readTriangles(primitive, count, where);
        if (indices.empty()) return;
        std::vector<Vec3f> normals = attribute<Vec3f>(primitive, "NORMAL", count, where);
        std::vector<Vec4f> tangents = attribute<Vec4f>(primitive, "TANGENT", count, where);
        transform(world, positions, normals, tangents, indices);

        const size_t firstVertex = scene_.positions.size(), firstIndex = scene_.indices.size();
        const size_t limit = std::numeric_limits<uint32_t>::max();
        if (count > limit - firstVertex || indices.size() > limit - firstIndex)
            throw InputError(path_, "has more vertices or triangles than 32-bit indices reach",
                             "split the mesh");
        ScenePrimitive run;
        run.firstVertex = uint32_t(firstVertex);
        run.vertexCount = uint32_t(count);
        run.firstIndex = uint32_t(firstIndex);
        run.indexCount = uint32_t(indices.size());
        run.material = materialOf(primitive, where);
        const int uvSet = materials_.uvSet[size_t(run.material)];
        append(scene_.positions, positions, firstVertex, count);
        append(scene_.normals, normals, firstVertex, count);
        append(scene_.tangents, tangents, firstVertex, count);
        append(scene_.uv0, attribute<Vec2f>(primitive, fmt::format("TEXCOORD_{}", uvSet), count, where),
               firstVertex, count);
        append(scene_.uv1, attribute<Vec2f>(primitive, "TEXCOORD_1", count, where), firstVertex, count);
        for (uint32_t index : indices) scene_.indices.push_back(run.firstVertex + index);
        scene_.primitives.push_back(run);
        finishEarlier();
    }

    /// An attribute that appears first in a late primitive, or is missing in the last, still has full length.
    void finishEarlier() {
        const size_t count = scene_.positions.size();
        const auto fill = [count](auto& values) {
            using Vector = typename std::decay_t<decltype(values)>::value_type;
            if (!values.empty()) values.resize(count, Vector::Zero());
        };
        fill(scene_.normals);
        fill(scene_.tangents);
        fill(scene_.uv0);
        fill(scene_.uv1);
    }

    static void transform(const Mat4d& world, std::vector<Vec3f>& positions, std::vector<Vec3f>& normals,
                          std::vector<Vec4f>& tangents, std::vector<uint32_t>& indices) {
        const bool identity = world == Mat4d::Identity();
        const Mat3d linear = world.topLeftCorner<3, 3>();
        const Vec3d offset = world.topRightCorner<3, 1>();
        const bool mirrored = linear.determinant() < 0;
        // The inverse transpose up to a positive factor, defined for flattening transforms too.
        Mat3d cofactor;
        cofactor.col(0) = Vec3d(linear.col(1)).cross(Vec3d(linear.col(2)));
        cofactor.col(1) = Vec3d(linear.col(2)).cross(Vec3d(linear.col(0)));
        cofactor.col(2) = Vec3d(linear.col(0)).cross(Vec3d(linear.col(1)));
        if (mirrored) cofactor = -cofactor;
        if (!identity)
            for (Vec3f& position : positions)
                position = Vec3d(linear * position.cast<double>() + offset).cast<float>();
        for (Vec3f& normal : normals)
            normal = normalizedOrZero(identity ? Vec3d(normal.cast<double>())
                                               : Vec3d(cofactor * normal.cast<double>()));
        for (Vec4f& tangent : tangents) {
            const Vec3d direction = tangent.head<3>().cast<double>();
            tangent.head<3>() = normalizedOrZero(identity ? direction : Vec3d(linear * direction));
            if (mirrored) tangent.w() = -tangent.w();
        }
        if (mirrored)
            for (size_t i = 0; i + 2 < indices.size(); i += 3) std::swap(indices[i + 1], indices[i + 2]);
    }

    const tinygltf::Model& model_;
    std::string path_;
    Materials materials_;
    Scene scene_;
    int defaultMaterial_ = -1, skipped_ = 0;
    bool morphed_ = false;
};

}  // namespace

Scene readGltf(const std::string& path) {
    const std::unique_ptr<tinygltf::Model> model = loadGltfModel(path);
    if (!model->skins.empty()) logWarning(path + ": skins are ignored; the mesh is read as it was modelled");
    return SceneBuilder(*model, path).build();
}

}  // namespace prt
