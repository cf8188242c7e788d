#include "precompute/io/point_channels.h"

#include <fmt/format.h>

#include <algorithm>

#include "precompute/base/error.h"

namespace prt {

void checkGrid(const PointGrid& grid) {
    PRT_CHECK(grid.width > 0 && grid.height > 0);
    if (grid.domain == PointDomain::Texel) PRT_CHECK_EQ(grid.count, gridPixels(grid));
    PRT_CHECK_LE(grid.count, gridPixels(grid));
}

void setDomain(const PointGrid& grid, ExrAttributes& attributes) {
    attributes.strings["domain"] = pointDomainName(grid.domain);
    if (grid.domain == PointDomain::Vertex) attributes.ints["vertexCount"] = int(grid.count);
}

PointGrid readGrid(const ExrPartInfo& part, const std::string& path) {
    const std::string& domain = requireString(part.attributes, "domain", path);
    if (domain == pointDomainName(PointDomain::Texel))
        return {PointDomain::Texel, part.width, part.height, size_t(part.width) * size_t(part.height)};
    if (domain != pointDomainName(PointDomain::Vertex))
        throw InputError(path, fmt::format("has points of an unknown domain \"{}\"", domain));
    const int64_t pixels = int64_t(part.width) * part.height;
    const int count =
        requireInt(part.attributes, "vertexCount", 0, int(std::min<int64_t>(pixels, INT32_MAX)), path);
    const PointGrid grid = vertexGrid(size_t(count));
    if (grid.width != part.width || grid.height != part.height)
        throw InputError(path, fmt::format("has {} x {} pixels for {} vertices, expected {} x {}", part.width,
                                           part.height, count, grid.width, grid.height));
    return grid;
}

std::vector<std::string> indexedNames(const std::string& prefix, int count) {
    std::vector<std::string> names;
    for (int i = 0; i < count; ++i) names.push_back(indexedName(prefix, i));
    return names;
}

void checkChannels(const ExrPartInfo& part, const std::vector<std::string>& names, const std::string& path) {
    for (const std::string& name : names)
        if (!part.channels.contains(name))
            throw InputError(path, fmt::format("has no channel {}", name),
                             "the file is damaged; make it again");
}

}  // namespace prt
