// First pass over an OBJ file: the damage that tinyobjloader lets through, or reports without its line.
// Syntax: Wavefront, "Advanced Visualizer Manual", appendix B1.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "precompute/base/error.h"
#include "precompute/mesh/readers.h"
#include "precompute/mesh/text_scanner.h"

namespace prt {
namespace {

constexpr std::array<const char*, 3> kNames{"vertex", "texture coordinate", "normal"};
/// tinyobjloader counts the corners of a face in a byte.
constexpr size_t kMaxObjCorners = 255;

struct ObjScan {
    std::string_view text;
    std::string where;
    std::array<size_t, 3> total{}, soFar{};  ///< v, vt, vn
    ObjCounts counts;
    size_t line = 0;

    [[noreturn]] void fail(const std::string& problem) const {
        throw InputError(fmt::format("{}:{}", where, line), problem, "re-export the mesh");
    }

    template <class Visit>
    void eachLine(const Visit& visit) {
        line = 0;
        for (size_t at = 0; at < text.size();) {
            const size_t end = std::min(text.find('\n', at), text.size());
            std::string_view rest = text.substr(at, end - at);
            ++line;
            at = end + 1;
            const std::string_view keyword = takeWord(rest);
            if (!keyword.empty()) visit(keyword, rest);
        }
    }

    void checkVertex(std::string_view rest) const;
    void checkIndex(size_t kind, std::string_view word) const;
    void checkFace(std::string_view rest);
};

void ObjScan::checkVertex(std::string_view rest) const {
    for (int axis = 0; axis < 3; ++axis) {
        const std::string_view word = takeWord(rest);
        const auto value = parseNumber(word);
        if (word.empty() || !value)
            fail(fmt::format("vertex {} does not have three coordinates", soFar[0] + 1));
        if (!std::isfinite(float(*value)))
            fail(fmt::format("vertex {} has a position that is not finite", soFar[0] + 1));
    }
}

void ObjScan::checkIndex(size_t kind, std::string_view word) const {
    const auto index = parseInteger(word);
    if (!index) fail(fmt::format("a face has a {} index that is no number", kNames[kind]));
    // Negative ones count back from the last element so far.
    const bool inRange =
        *index > 0 ? size_t(*index) <= total[kind] : *index < 0 && size_t(-(*index + 1)) < soFar[kind];
    if (!inRange)
        fail(fmt::format("face uses {} {} of {}", kNames[kind], *index,
                         *index < 0 ? soFar[kind] : total[kind]));
}

void ObjScan::checkFace(std::string_view rest) {
    size_t corners = 0;
    for (std::string_view word = takeWord(rest); !word.empty() && word[0] != '#'; word = takeWord(rest)) {
        if (word == "\\") fail("a face continues on the next line, which is not read");
        // tinyobjloader would take the next corner for its normal.
        if (word.back() == '/') fail("a corner of a face ends in '/'");
        ++corners;
        for (size_t kind = 0; kind < 3 && !word.empty(); ++kind) {
            const size_t slash = std::min(word.find('/'), word.size());
            if (slash > 0 || kind == 0) checkIndex(kind, word.substr(0, slash));
            word.remove_prefix(std::min(slash + 1, word.size()));
        }
    }
    if (corners > kMaxObjCorners)
        fail(fmt::format("a face has {} corners, more than {}: triangulate it", corners, kMaxObjCorners));
    ++counts.faces;
    counts.polygons += corners > 3;
}

}  // namespace

ObjCounts scanObj(std::string_view text, const std::string& where) {
    ObjScan scan{text, where, {}, {}, {}, 0};
    scan.eachLine([&](std::string_view keyword, std::string_view) {
        scan.total[0] += keyword == "v";
        scan.total[1] += keyword == "vt";
        scan.total[2] += keyword == "vn";
    });
    scan.eachLine([&](std::string_view keyword, std::string_view rest) {
        if (keyword == "v") scan.checkVertex(rest);
        if (keyword == "f") scan.checkFace(rest);
        scan.soFar[0] += keyword == "v";
        scan.soFar[1] += keyword == "vt";
        scan.soFar[2] += keyword == "vn";
    });
    scan.counts.vertices = scan.total[0];
    if (scan.counts.faces == 0)
        throw InputError(where, fmt::format("has no faces ({} vertices)", scan.total[0]),
                         "export it as a polygon mesh, not as points or curves");
    return scan.counts;
}

}  // namespace prt
