// Sources: compress/export_textures.h, whose textures tests compare with these counts.
#include "compress/shipped_bytes.h"

#include <algorithm>

#include "precompute/base/check.h"

namespace prt {
namespace {

size_t layersOf(int values) {
    PRT_CHECK_LE(1, values);
    return (size_t(values) + 3) / 4;
}

}  // namespace

const std::vector<std::string>& pointEncodings() {
    static const std::vector<std::string> names = {"float", "half", "unorm16", "unorm8"};
    return names;
}

const std::vector<std::string>& tableEncodings() {
    static const std::vector<std::string> names = {"float", "half", "rgb9e5", "r11f"};
    return names;
}

size_t shippedBytes(int values, const std::string& encoding) {
    const auto found = std::find(pointEncodings().begin(), pointEncodings().end(), encoding);
    PRT_CHECK(found != pointEncodings().end());
    const size_t bytesOfValue = encoding == "float" ? 4 : encoding == "unorm8" ? 1 : 2;
    return 4 * layersOf(values) * bytesOfValue;
}

size_t shippedTableBytes(int values, bool hasMean, const std::string& encoding) {
    const size_t mean = hasMean ? 1 : 0;
    if (encoding == "rgb9e5" || encoding == "r11f") return 4 * (size_t(values) + mean);
    PRT_CHECK(encoding == "float" || encoding == "half");
    return (3 * layersOf(values) + mean) * 4 * (encoding == "float" ? 4 : 2);
}

}  // namespace prt
