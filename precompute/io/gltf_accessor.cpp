// Sources: glTF 2.0 specification, sections 3.6.2 (accessors, sparse accessors, alignment) and 3.11
// (normalised integers); KHR_mesh_quantization.
#include "precompute/io/gltf_accessor.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>

#include "precompute/base/error.h"

namespace prt {
namespace {

// An accessor without a buffer view holds zeros: nothing else bounds its count.
constexpr size_t kMaxElements = size_t(1) << 28;

const tinygltf::Accessor& getAccessor(const tinygltf::Model& model, int index, const std::string& where) {
    if (index < 0 || size_t(index) >= model.accessors.size())
        throw InputError(where, fmt::format("uses accessor {} of {}", index, model.accessors.size()),
                         "export the mesh again");
    return model.accessors[size_t(index)];
}

size_t componentBytes(int componentType) {
    switch (componentType) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            return 0;
    }
}

template <class Value>
Value load(const uint8_t* bytes) {
    Value value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

float loadFloat(const uint8_t* bytes, int componentType, bool normalized) {
    switch (componentType) {
        case TINYGLTF_COMPONENT_TYPE_BYTE: {
            const float value = load<int8_t>(bytes);
            return normalized ? std::max(value / 127.0f, -1.0f) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
            const float value = load<uint8_t>(bytes);
            return normalized ? value / 255.0f : value;
        }
        case TINYGLTF_COMPONENT_TYPE_SHORT: {
            const float value = load<int16_t>(bytes);
            return normalized ? std::max(value / 32767.0f, -1.0f) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
            const float value = load<uint16_t>(bytes);
            return normalized ? value / 65535.0f : value;
        }
        default:
            return load<float>(bytes);
    }
}

uint32_t loadIndex(const uint8_t* bytes, int componentType) {
    switch (componentType) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return load<uint8_t>(bytes);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return load<uint16_t>(bytes);
        default:
            return load<uint32_t>(bytes);
    }
}

/// `count` elements of `elementBytes`, `stride` apart, from `offset` in a buffer view.
struct Elements {
    const uint8_t* first = nullptr;
    size_t stride = 0;
    const uint8_t* at(size_t i) const { return first + i * stride; }
};

Elements findElements(const tinygltf::Model& model, int view, size_t offset, size_t count,
                      size_t elementBytes, const std::string& where) {
    const std::span<const uint8_t> bytes = gltfViewBytes(model, view, where);
    const size_t declared = model.bufferViews[size_t(view)].byteStride;
    const size_t stride = declared == 0 ? elementBytes : declared;
    if (stride < elementBytes)
        throw InputError(where, fmt::format("buffer view {} has a stride of {} bytes for elements of {}",
                                            view, stride, elementBytes));
    if (count == 0) return {bytes.data(), stride};
    // Written so that no product or sum can overflow.
    const bool fits = offset <= bytes.size() && bytes.size() - offset >= elementBytes &&
                      (count - 1) <= (bytes.size() - offset - elementBytes) / stride;
    if (!fits)
        throw InputError(
            where,
            fmt::format("{} elements of {} bytes from byte {} reach beyond buffer view {} of {} bytes", count,
                        elementBytes, offset, view, bytes.size()),
            "the file is damaged; export the mesh again");
    return {bytes.data() + offset, stride};
}

Elements findSparse(const tinygltf::Model& model, int view, int offset, size_t count, size_t elementBytes,
                    const std::string& where) {
    if (offset < 0) throw InputError(where, "a sparse accessor has a negative offset");
    const Elements found = findElements(model, view, size_t(offset), count, elementBytes, where);
    return {found.first, elementBytes};
}

/// Indices of the elements that a sparse accessor replaces.
std::vector<size_t> sparseTargets(const tinygltf::Model& model, const tinygltf::Accessor& accessor,
                                  const std::string& where) {
    const auto& sparse = accessor.sparse;
    if (sparse.count < 1 || size_t(sparse.count) > accessor.count)
        throw InputError(
            where, fmt::format("a sparse accessor replaces {} of {} elements", sparse.count, accessor.count));
    const int type = sparse.indices.componentType;
    if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
        throw InputError(where, fmt::format("a sparse accessor has indices of type {}", type));
    const Elements elements = findSparse(model, sparse.indices.bufferView, sparse.indices.byteOffset,
                                         size_t(sparse.count), componentBytes(type), where);
    std::vector<size_t> targets;
    for (size_t i = 0; i < size_t(sparse.count); ++i) {
        targets.push_back(loadIndex(elements.at(i), type));
        if (targets.back() >= accessor.count)
            throw InputError(where, fmt::format("a sparse accessor replaces element {} of {}", targets.back(),
                                                accessor.count));
    }
    return targets;
}

/// Calls use(element, bytes) for every element, first the plain ones, then the sparse replacements.
template <class Use>
void forEachElement(const tinygltf::Model& model, const tinygltf::Accessor& accessor, size_t elementBytes,
                    const std::string& where, const Use& use) {
    if (accessor.bufferView >= 0) {
        const Elements elements = findElements(model, accessor.bufferView, accessor.byteOffset,
                                               accessor.count, elementBytes, where);
        for (size_t i = 0; i < accessor.count; ++i) use(i, elements.at(i));
    }
    if (!accessor.sparse.isSparse) return;
    const std::vector<size_t> targets = sparseTargets(model, accessor, where);
    const Elements values =
        findSparse(model, accessor.sparse.values.bufferView, accessor.sparse.values.byteOffset,
                   targets.size(), elementBytes, where);
    for (size_t i = 0; i < targets.size(); ++i) use(targets[i], values.at(i));
}

/// Refuses a count before anything of that size is allocated.
void checkCount(const tinygltf::Model& model, const tinygltf::Accessor& accessor, size_t elementBytes,
                const std::string& where) {
    if (accessor.bufferView >= 0) {
        findElements(model, accessor.bufferView, accessor.byteOffset, accessor.count, elementBytes, where);
    } else if (accessor.count > kMaxElements) {
        throw InputError(where, fmt::format("promises {} elements without a buffer", accessor.count));
    }
}

}  // namespace

std::span<const uint8_t> gltfViewBytes(const tinygltf::Model& model, int view, const std::string& where) {
    if (view < 0 || size_t(view) >= model.bufferViews.size())
        throw InputError(where, fmt::format("uses buffer view {} of {}", view, model.bufferViews.size()),
                         "export the mesh again");
    const tinygltf::BufferView& found = model.bufferViews[size_t(view)];
    if (found.buffer < 0 || size_t(found.buffer) >= model.buffers.size())
        throw InputError(
            where,
            fmt::format("buffer view {} uses buffer {} of {}", view, found.buffer, model.buffers.size()),
            "export the mesh again");
    const std::vector<unsigned char>& bytes = model.buffers[size_t(found.buffer)].data;
    if (found.byteOffset > bytes.size() || found.byteLength > bytes.size() - found.byteOffset)
        throw InputError(
            where,
            fmt::format("buffer view {} (offset {}, {} bytes) reaches beyond its buffer of {} bytes", view,
                        found.byteOffset, found.byteLength, bytes.size()),
            "the file is damaged; export the mesh again");
    return {bytes.data() + found.byteOffset, found.byteLength};
}

size_t gltfAccessorCount(const tinygltf::Model& model, int accessor, const std::string& where) {
    return getAccessor(model, accessor, where).count;
}

std::vector<float> readGltfFloats(const tinygltf::Model& model, int index, int components,
                                  const std::string& where) {
    const tinygltf::Accessor& accessor = getAccessor(model, index, where);
    const size_t bytes = componentBytes(accessor.componentType);
    if (bytes == 0 || accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
        throw InputError(where,
                         fmt::format("accessor {} has the component type {}", index, accessor.componentType),
                         "export the attribute as floats");
    if (tinygltf::GetNumComponentsInType(uint32_t(accessor.type)) != components)
        throw InputError(where,
                         fmt::format("accessor {} has not {} components per element", index, components),
                         "export the mesh again");
    const size_t width = size_t(components);
    checkCount(model, accessor, bytes * width, where);
    std::vector<float> values(accessor.count * width);
    forEachElement(model, accessor, bytes * width, where, [&](size_t element, const uint8_t* from) {
        for (size_t c = 0; c < width; ++c)
            values[element * width + c] =
                loadFloat(from + c * bytes, accessor.componentType, accessor.normalized);
    });
    return values;
}

std::vector<uint32_t> readGltfIndices(const tinygltf::Model& model, int index, const std::string& where) {
    const tinygltf::Accessor& accessor = getAccessor(model, index, where);
    const int type = accessor.componentType;
    if (accessor.type != TINYGLTF_TYPE_SCALAR ||
        (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
         type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
        throw InputError(where, fmt::format("accessor {} holds no vertex indices", index),
                         "export the mesh again");
    const size_t bytes = componentBytes(type);
    checkCount(model, accessor, bytes, where);
    std::vector<uint32_t> values(accessor.count);
    forEachElement(model, accessor, bytes, where,
                   [&](size_t element, const uint8_t* from) { values[element] = loadIndex(from, type); });
    return values;
}

}  // namespace prt
