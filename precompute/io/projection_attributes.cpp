// The project's own attributes (tools/docs/formats.md).
#include "precompute/io/projection_attributes.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "precompute/base/error.h"

namespace prt {
namespace {

constexpr const char *kKind = "projection", *kCone = "projectionConeDegrees", *kFloor = "projectionFloor";

// Takes a number out of the attributes; NaN where there is none.
double takeNumber(std::map<std::string, std::string>& attributes, const char* name) {
    double value = NAN;
    if (const auto found = attributes.find(name); found != attributes.end()) {
        const std::string& text = found->second;
        const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
        if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size()) value = NAN;
        attributes.erase(found);
    }
    return value;
}

}  // namespace

const char* projectionName(ProjectionKind kind) {
    return kind == ProjectionKind::Plain ? "plain" : "irradiance";
}

void setProjection(const Projection& projection, std::map<std::string, std::string>& attributes) {
    attributes[kKind] = projectionName(projection.kind);
    attributes.erase(kCone);
    attributes.erase(kFloor);
    if (projection.kind == ProjectionKind::Plain) return;
    attributes[kCone] = fmt::format("{}", projection.weight.coneDegrees);
    attributes[kFloor] = fmt::format("{}", projection.weight.floor);
}

Projection takeProjection(std::map<std::string, std::string>& attributes, const std::string& path) {
    const IrradianceWeight weight{takeNumber(attributes, kCone), takeNumber(attributes, kFloor)};
    const auto found = attributes.find(kKind);
    const std::string kind = found == attributes.end() ? "plain" : found->second;
    attributes.erase(kKind);
    if (kind == projectionName(ProjectionKind::Plain)) return kPlainProjection;
    if (kind != projectionName(ProjectionKind::Irradiance))
        throw InputError(path, fmt::format("holds visibility of an unknown projection \"{}\"", kind),
                         "it was written by another version of prt, or it is damaged; make it again");
    if (!isValid(weight))
        throw InputError(path,
                         fmt::format("does not say how its projection for irradiance was weighted ({} "
                                     "and {} are absent or out of range)",
                                     kCone, kFloor),
                         "the file is damaged; make it again");
    return {ProjectionKind::Irradiance, weight};
}

}  // namespace prt
