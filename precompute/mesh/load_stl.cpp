// Stereolithography files, text and binary. Layout: M. Burns, "Automated Fabrication", 1993, section 6.5.
#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>
#include <cstring>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/mesh/readers.h"
#include "precompute/mesh/text_scanner.h"

namespace prt {
namespace {

constexpr size_t kHeaderBytes = 84, kTriangleBytes = 50;

/// Some binary files start with "solid" too: those have bytes that text has not, or exactly the right size.
bool isText(std::string_view bytes) {
    if (bytes.substr(0, 5) != "solid") return false;
    if (bytes.size() >= kHeaderBytes) {
        uint32_t count;
        std::memcpy(&count, bytes.data() + 80, 4);
        if (bytes.size() == kHeaderBytes + kTriangleBytes * size_t(count)) return false;
    }
    for (char c : bytes.substr(0, 512))
        if (c == '\0' || static_cast<unsigned char>(c) > 126) return false;
    return true;
}

void addTriangle(CornerMesh& mesh, const std::array<Vec3f, 3>& corners) {
    for (const Vec3f& corner : corners) {
        mesh.position.push_back(uint32_t(mesh.positions.size()));
        mesh.positions.push_back(corner);
    }
    mesh.material.push_back(0);
}

CornerMesh readBinary(std::string_view bytes, const std::string& where) {
    if (bytes.size() < kHeaderBytes)
        throw InputError(
            where,
            fmt::format("has {} bytes, fewer than the {} of an STL header", bytes.size(), kHeaderBytes),
            "copy or export the file again");
    uint32_t count;
    std::memcpy(&count, bytes.data() + 80, 4);
    const size_t present = (bytes.size() - kHeaderBytes) / kTriangleBytes;
    if (present < count)
        throw InputError(
            where, fmt::format("is truncated: its header promises {} triangles, it holds {}", count, present),
            "copy or export the file again");
    CornerMesh mesh;
    mesh.positions.reserve(size_t(count) * 3);
    for (size_t t = 0; t < count; ++t) {
        std::array<float, 9> numbers;
        std::memcpy(numbers.data(), bytes.data() + kHeaderBytes + t * kTriangleBytes + 12, sizeof numbers);
        std::array<Vec3f, 3> corners;
        for (size_t k = 0; k < 3; ++k) {
            corners[k] = Vec3f(numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]);
            if (!corners[k].allFinite())
                throw InputError(where, fmt::format("vertex {} of triangle {} is not finite", k, t),
                                 "re-export the mesh");
        }
        addTriangle(mesh, corners);
    }
    return mesh;
}

CornerMesh readText(std::string_view text, const std::string& where) {
    CornerMesh mesh;
    TextScanner scanner(text, where);
    scanner.restOfLine();
    const auto expect = [&](std::string_view keyword) {
        const std::string_view word = scanner.word();
        if (word.empty())
            scanner.fail(fmt::format("the file is truncated after {} triangles: '{}' is missing",
                                     mesh.triangleCount(), keyword));
        if (word != keyword) scanner.fail(fmt::format("'{}' is missing", keyword));
    };
    for (;;) {
        const std::string_view word = scanner.word();
        if (word.empty())
            scanner.fail(fmt::format("the file is truncated after {} triangles: 'endsolid' is missing",
                                     mesh.triangleCount()));
        if (word == "endsolid") {
            scanner.restOfLine();
            if (scanner.word() != "solid") break;
            scanner.restOfLine();
            continue;
        }
        if (word != "facet") scanner.fail("'facet' is missing");
        expect("normal");
        // Some exporters write words such as "nan" for normals: they are made anew anyway.
        for (int i = 0; i < 3; ++i) scanner.word();
        expect("outer");
        expect("loop");
        std::array<Vec3f, 3> corners;
        for (Vec3f& corner : corners) {
            expect("vertex");
            for (int i = 0; i < 3; ++i) corner[i] = float(scanner.number("a coordinate"));
            if (!corner.allFinite()) scanner.fail("a vertex has a position that is not finite");
        }
        expect("endloop");
        expect("endfacet");
        addTriangle(mesh, corners);
    }
    return mesh;
}

}  // namespace

CornerMesh readStl(const std::filesystem::path& path, LoadMeshReport&) {
    const std::string bytes = readFile(path);
    return isText(bytes) ? readText(bytes, path.string()) : readBinary(bytes, path.string());
}

}  // namespace prt
