// Object File Format with its optional normals, colours and texture coordinates, as text. Syntax: Geomview
// manual, "OFF: general polyhedral objects".
#include <fmt/format.h>

#include <cmath>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/mesh/readers.h"
#include "precompute/mesh/text_scanner.h"

namespace prt {
namespace {

struct OffHeader {
    bool texcoords = false, colours = false, normals = false;
    size_t vertices = 0, faces = 0;
};

/// Key word [ST][C][N]OFF, then the counts of vertices, faces and edges, on one line or more.
OffHeader readHeader(TextScanner& scanner, size_t bytes) {
    OffHeader header;
    std::string_view line = scanner.contentLine();
    std::string_view word = takeWord(line);
    const auto take = [&](std::string_view prefix) {
        if (!word.starts_with(prefix)) return false;
        word.remove_prefix(prefix.size());
        return true;
    };
    header.texcoords = take("ST");
    header.colours = take("C");
    header.normals = take("N");
    if (word != "OFF")
        scanner.fail("the file does not start with OFF (of its variants, those with ST, C and N are read)");
    std::string_view vertices = takeWord(line);
    if (vertices == "BINARY") scanner.fail("binary OFF is not read");
    if (vertices.empty()) {
        line = scanner.contentLine();
        vertices = takeWord(line);
    }
    const auto vertexCount = parseInteger(vertices), faceCount = parseInteger(takeWord(line));
    if (!vertexCount || !faceCount || *vertexCount < 0 || *faceCount < 0)
        scanner.fail("the counts of vertices and faces are missing");
    header.vertices = size_t(*vertexCount);
    header.faces = size_t(*faceCount);
    // "0 0 0\n" and "3 0 1 2\n" are the shortest lines that could hold them.
    if (header.vertices > bytes / 5 || header.faces > bytes / 5)
        scanner.fail(fmt::format("the header promises {} vertices and {} faces, more than {} bytes can hold",
                                 header.vertices, header.faces, bytes));
    return header;
}

void readVertex(TextScanner& scanner, const OffHeader& header, size_t vertex, CornerMesh& mesh) {
    std::string_view line = scanner.contentLine();
    if (line.empty())
        scanner.fail(fmt::format("the file ends after vertex {} of {}", vertex, header.vertices));
    std::vector<double> numbers;
    for (std::string_view word = takeWord(line); !word.empty(); word = takeWord(line)) {
        const auto value = parseNumber(word);
        if (!value) scanner.fail(fmt::format("vertex {} has a coordinate that is not a number", vertex));
        numbers.push_back(*value);
    }
    const size_t needed = 3 + (header.normals ? 3 : 0) + (header.texcoords ? 2 : 0);
    if (numbers.size() < needed)
        scanner.fail(fmt::format("vertex {} has {} numbers, {} are needed", vertex, numbers.size(), needed));
    mesh.positions.emplace_back(float(numbers[0]), float(numbers[1]), float(numbers[2]));
    if (!mesh.positions.back().allFinite())
        scanner.fail(fmt::format("vertex {} has a position that is not finite", vertex));
    if (header.normals) mesh.normals.emplace_back(float(numbers[3]), float(numbers[4]), float(numbers[5]));
    // Their v points up.
    if (header.texcoords)
        mesh.uv0.emplace_back(float(numbers[numbers.size() - 2]), float(1 - numbers.back()));
}

}  // namespace

CornerMesh readOff(const std::filesystem::path& path, LoadMeshReport& report) {
    const std::string text = readFile(path);
    TextScanner scanner(text, path.string());
    const OffHeader header = readHeader(scanner, text.size());
    CornerMesh mesh;
    for (size_t v = 0; v < header.vertices; ++v) readVertex(scanner, header, v, mesh);
    PolygonAppender polygons(mesh, report);
    std::vector<uint32_t> corners;
    for (size_t f = 0; f < header.faces; ++f) {
        std::string_view line = scanner.contentLine();
        if (line.empty()) scanner.fail(fmt::format("the file ends after face {} of {}", f, header.faces));
        const auto count = parseInteger(takeWord(line));
        if (!count || *count < 1)
            scanner.fail(fmt::format("face {} does not start with its number of corners", f));
        corners.clear();
        for (long long k = 0; k < *count; ++k) {
            const auto index = parseInteger(takeWord(line));
            if (!index) scanner.fail(fmt::format("face {} has {} of {} corners", f, k, *count));
            if (*index < 0 || size_t(*index) >= header.vertices)
                scanner.fail(fmt::format("face uses vertex {} of {}", *index, header.vertices));
            corners.push_back(uint32_t(*index));
        }
        const std::span<const uint32_t> none, same(corners);
        polygons.append(corners, header.normals ? same : none, header.texcoords ? same : none, 0,
                        path.string());
    }
    return mesh;
}

}  // namespace prt
